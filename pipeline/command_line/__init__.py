"""The command line: commands, options, what people see in a terminal."""
