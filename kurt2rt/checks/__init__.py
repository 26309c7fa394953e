"""Checks of a robot and of this software: doctor, commission, plug-ins."""
