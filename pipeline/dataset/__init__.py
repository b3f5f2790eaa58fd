"""Many sequences with one configuration, on a timetable."""
