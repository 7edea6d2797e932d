# One fault of each class has the expected result.
# SPDX-License-Identifier: BSD-3-Clause
from processes import find_program, output_of
from run_files import read_rows


def test_all_quick_cases_pass(tmp_path):
    output = output_of([find_program("fault_table"), "--subset", "quick", "--out", tmp_path], limit_s=500.0)
    header, *rows = read_rows(tmp_path, "faults.csv")
    assert header == ["case", "phase", "fault", "expected", "observed", "passed"]
    assert not [row for row in rows if row[3] != row[4] or row[5] != "1"], output
    assert len(rows) == 7
    assert "7 passed, 0 failed" in output
