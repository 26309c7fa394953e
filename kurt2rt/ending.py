"""The signals that end a program which drives a robot."""

import signal

ENDING = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGQUIT, signal.SIGTSTP)
"""Ctrl-\\ and Ctrl-Z among them: a program that is stopped or dies on the spot does not brake."""
