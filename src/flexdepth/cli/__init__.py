"""The command line: `main` chooses a command, and each command is one thin file."""
