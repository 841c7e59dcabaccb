"""The checks of students' programs: the stage they run on, and what is asked of each."""
