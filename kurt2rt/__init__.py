"""The runtime: clock, scheduler, perception, rule-like associations, teaching and knowledge."""
