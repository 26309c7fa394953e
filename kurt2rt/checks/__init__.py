"""Checks of a robot and of this software: doctor, commission, faults, soak, bench."""
