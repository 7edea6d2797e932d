# One fault of each class has the expected result, and a case with another result fails.
# SPDX-License-Identifier: BSD-3-Clause
from ddm_qa.fault_cases import RECOVERS, Case
from ddm_qa.fault_run import FaultBench
from processes import call, find_program
from run_files import read_rows


def test_all_quick_cases_pass(tmp_path):
    code, output = call([find_program("fault_table"), "--subset", "quick", "--out", tmp_path], limit_s=500.0)
    header, *rows = read_rows(tmp_path, "faults.csv")
    assert header == ["case", "phase", "fault", "expected", "observed", "passed"]
    assert not [row for row in rows if row[3] != row[4] or row[5] != "1"], output
    assert len(rows) == 8
    assert "8 passed, 0 failed" in output and code == 0, output


def test_a_fault_whose_phase_never_comes_is_no_success(tmp_path):
    assert FaultBench(str(tmp_path)).run(Case("never", "no such phase", "drop image", RECOVERS, ())) == "not injected"
