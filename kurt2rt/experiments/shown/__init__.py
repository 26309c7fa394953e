"""How experiments are shown: tables, intervals, figures, one page that holds everything."""
