"""The benchmarks run: each tells its rows, next to a reference that took time."""

from pathlib import Path

import pytest

from tests.bench import BENCHES, as_table, measure


@pytest.mark.deep
async def test_each_benchmark_tells_its_rows(tmp_path: Path) -> None:
    rows = await measure(list(BENCHES), tmp_path, share=0.01)
    assert len(rows) == 14
    assert all(row.took.median_us > 0.0 and row.reference_us > 0.0 for row in rows)
    assert len(list(as_table(rows))) == 2 + len(rows)
