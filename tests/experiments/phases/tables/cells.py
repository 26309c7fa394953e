"""A row of a table by the names of its columns."""

from kurt2rt.experiments.study.table import Table


def cells(sheet: Table, place: int) -> dict[str, str]:
    row = dict(zip(sheet.columns, sheet.rows[place], strict=True))
    assert len(sheet.rows[place]) == len(sheet.columns)
    return row
