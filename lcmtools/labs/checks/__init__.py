"""The checks of students' programs: the test bench they run on, and what each measures."""
