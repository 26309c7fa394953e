"""Checks of a robot and of this software: doctor, commission, bench, plug-ins."""
