"""Experiments with learners that are no RLA systems, taught by the same teacher."""
