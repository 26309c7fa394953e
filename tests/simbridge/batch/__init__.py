"""Tests of the batch simulator."""
