"""The checks of students' programs, and the test bench that runs the programs."""
