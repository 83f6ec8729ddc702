"""The pFUnit substitute passes what pFUnit passes, fails what it fails, refuses what it refuses."""
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(os.environ["COULTER_SOURCE_DIR"])
FUNIT = ROOT / "tests" / "support" / "funit"
FLAGS = ["-std=f2018", "-ffree-line-length-none", "-fimplicit-none"]


@pytest.fixture(scope="session")
def runtime(tmp_path_factory):
    """The compiled substitute library, as a folder."""
    folder = tmp_path_factory.mktemp("funit")
    for name in ("funit_core", "funit_typed", "funit_basic", "funit"):
        subprocess.run(["gfortran", *FLAGS, "-c", FUNIT / f"{name}.f90"], cwd=folder, check=True)
    return folder


def preprocess(tmp_path, text, name="test_x"):
    (tmp_path / f"{name}.pf").write_text(text, encoding="utf-8")
    return subprocess.run(
        [sys.executable, FUNIT / "preprocess.py", f"{name}.pf", f"{name}.F90"],
        cwd=tmp_path, capture_output=True, text=True, check=False)


def run(tmp_path, runtime, text):
    """Exit status and output of the test program made from one .pf file."""
    made = preprocess(tmp_path, text)
    assert made.returncode == 0, made.stderr
    (tmp_path / "driver.f90").write_text(
        "program driver\nuse funit\ncall test_x_suite()\ncall finish_run()\nend\n",
        encoding="utf-8")
    built = subprocess.run(
        ["gfortran", *FLAGS, f"-I{runtime}", "test_x.F90", "driver.f90",
         *sorted(runtime.glob("*.o")), "-o", "x"],
        cwd=tmp_path, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr
    result = subprocess.run([tmp_path / "x"], capture_output=True, text=True, check=False)
    return result.returncode, result.stdout


def module(*tests, before=""):
    """A test module; every test is the list of its lines."""
    body = "".join(f"@test\nsubroutine t{i}()\n{test}\nend subroutine t{i}\n"
                   for i, test in enumerate(tests, 1))
    return (f"module test_x\nuse funit\nuse, intrinsic :: iso_fortran_env\n"
            f"use, intrinsic :: ieee_arithmetic\nimplicit none\n"
            f"contains\n{before}{body}end module test_x\n")


PASSING = [
    "@assertEqual(1, 1)",
    "@assertEqual(1_int64, 1_int64)",
    "@assertEqual(0, [0, 0])",
    "@assertEqual([1, 2], [1, 2], message='list')",
    "@assertEqual(1.0, 1.0)",
    "@assertEqual(1.0_real64, 1.0_real64)",
    "@assertEqual(1.0_real64, 1.25_real64, tolerance=0.25_real64)",
    "@assertEqual(1.0_real64, reshape([1.0_real64, 1.0_real64], [1, 2]))",
    "@assertEqual(ieee_value(1.0, ieee_positive_inf), ieee_value(1.0, ieee_positive_inf))",
    '@assertEqual("a, (b", "a, (b", message="it\'s ""quoted"" @here!")',
    "@assertEqual(['ab', 'c '], ['ab', 'c '])",
    "@assertEqual(.true., .true.)",
    "@assertNotEqual(1.0, 2.0)",
    "@assertRelativelyEqual(100.0, 101.0, tolerance=0.01)",
    "@assertRelativelyEqual(100.0, 101.0, 0.01)",
    "@assertLessThan(1, 2)",
    "@assertLessThan(0.0, [1.0, 2.0])",
    "@assertLessThanOrEqual(1.0, 1.0)",
    "@assertGreaterThan(2.0_real64, 1.0_real64)",
    "@assertGreaterThanOrEqual(2, 2)",
    "@assertTrue(.true.)",
    "@assertTrue([.true., .true.], 'all')",
    "@assertFalse(.false., message='none')",
    "@assertIsNaN(ieee_value(1.0_real64, ieee_quiet_nan))",
    "@assertIsFinite(1.0)",
    "@assertSameShape([2, 3], shape(reshape([1, 2, 3, 4, 5, 6], [2, 3])))",
    "call throw('raised')\n@assertExceptionRaised()",
    "call throw('raised')\n@assertExceptionRaised('raised')",
    "block\ninteger, pointer :: p\nallocate (p)\n@assertAssociated(p)\nend block",
    "block\ninteger, pointer :: p\ninteger, target :: q\np => q\n"
    "@assertAssociated(p, q, message='q')\nend block",
]

# what fails, and what its report must show
FAILING = [
    ("@assertEqual(1, 2)", "expected 1, found 2"),
    ("@assertEqual([1, 2], [1, 3])", "found 3 at element (2)"),
    ("@assertEqual([1, 2], [1, 2, 3])", "expected shape (2), found shape (3)"),
    ("@assertEqual([1], 1)", "expected shape (1)"),
    ("@assertEqual(1.0, reshape([1.0, 1.0, 2.0, 1.0], [2, 2]))", "at element (1, 2)"),
    ("@assertEqual(1.0_real64, 1.3_real64, tolerance=0.25_real64)", "(tolerance 0.25"),
    ("@assertEqual(1.0, ieee_value(1.0, ieee_quiet_nan), tolerance=1.0)", "found NaN"),
    ("@assertEqual(1.0, ieee_value(1.0, ieee_positive_inf), tolerance=huge(1.0))", "found Inf"),
    ("@assertEqual('a', ' a')", 'found " a"'),
    ("@assertEqual(.true., .false.)", "expected true, found false"),
    ("@assertNotEqual([1, 2], [3, 2])", "expected /= 2, found 2 at element (2)"),
    ("@assertNotEqual(1.0, ieee_value(1.0, ieee_quiet_nan))", "NaN"),
    ("@assertRelativelyEqual(0.0, 0.0, 0.1)", "expected relatively"),
    ("@assertRelativelyEqual(100.0, 102.0, 0.01)", "found 102"),
    ("@assertLessThan(1, 1)", "right > 1"),
    ("@assertLessThanOrEqual(2.0, 1.0)", "right >= 2"),
    ("@assertGreaterThan(1.0, 1.0)", "right < 1"),
    ("@assertGreaterThanOrEqual(1, 2)", "right <= 1"),
    ("@assertTrue(.false., message='why')", "why"),
    ("@assertTrue([.true., .false.])", "found a false"),
    ("@assertFalse(.true.)", "expected false"),
    ("@assertIsNaN(1.0)", "expected NaN"),
    ("@assertIsFinite(ieee_value(1.0, ieee_quiet_nan))", "expected a finite value"),
    ("@assertSameShape([2, 3], [3, 2])", "found shape (3, 2)"),
    ("@assertFail('not written')", "not written"),
    ("@assertExceptionRaised()", "found none"),
    ("call throw('one')\n@assertExceptionRaised('two')", "found none"),
    ("block\ninteger, pointer :: p\nnullify (p)\n@assertAssociated(p)\nend block", "expected true"),
    # a failure inside a called procedure is a failure of the test, counted once
    ("call assertEqual(1, 2)\ncall assertEqual(3, 4)", "expected 3, found 4"),
]


def test_what_holds_passes(tmp_path, runtime):
    status, output = run(tmp_path, runtime, module(*PASSING))
    assert (status, output) == (0, f" OK ({len(PASSING)} tests)\n")


def test_what_does_not_hold_fails(tmp_path, runtime):
    text = module(*(test for test, _ in FAILING), "@assertTrue(.true.)")
    status, output = run(tmp_path, runtime, text)
    assert status == 2
    assert output.endswith(f"FAILED ({len(FAILING) + 1} tests, {len(FAILING)} failures)\n")
    for i, (_, report) in enumerate(FAILING, 1):
        reports = [part for part in output.split("failure in ") if part.startswith(f"t{i}\n")]
        assert any(report in part for part in reports), report


def test_a_failure_names_its_line_and_ends_its_test_only(tmp_path, runtime):
    text = module("@assertEqual(1, 2)\n@assertEqual(3, 4)", "@assertEqual(5, 6)")
    line = text.splitlines().index("@assertEqual(1, 2)") + 1
    _, output = run(tmp_path, runtime, text)
    assert f"test_x.pf:{line}: failure in t1\n   expected 1, found 2\n" in output
    assert "expected 3" not in output
    assert "expected 5" in output


def test_before_and_after_enclose_every_test(tmp_path, runtime):
    hooks = ("@before\nsubroutine b()\nprint '(a)', 'before'\nend subroutine b\n"
             "@after\nsubroutine a()\nprint '(a)', 'after'\nend subroutine a\n")
    text = module("print '(a)', '1'", "print '(a)', '2'", before=hooks)
    status, output = run(tmp_path, runtime, text)
    assert (status, output) == (0, "before\n1\nafter\nbefore\n2\nafter\n OK (2 tests)\n")


def test_a_disabled_test_does_not_run(tmp_path, runtime):
    text = module("@assertFail('ran')", "@assertTrue(.true.)")
    status, output = run(tmp_path, runtime, text.replace("@test\n", "@test\n@disable\n", 1))
    assert (status, output) == (0, "disabled: t1\n OK (1 tests, 1 disabled)\n")


PARAMETRISED = """module test_x
use funit
implicit none
@testParameter(constructor=new_number)
type, extends(AbstractTestParameter) :: number_type
   integer :: n
contains
   procedure :: toString
end type
@testCase(constructor=new_case)
type, extends(ParameterizedTestCase) :: case_type
   integer :: n
contains
   procedure :: setUp
end type
contains
function new_number(n) result(number)
   integer, intent(in) :: n
   type(number_type) :: number
   number%n = n
end function
function toString(this) result(string)
   class(number_type), intent(in) :: this
   character(len=:), allocatable :: string
   string = achar(48 + this%n)
end function
function new_case(number) result(case)
   type(number_type), intent(in) :: number
   type(case_type) :: case
   case%n = number%n
end function
subroutine setUp(this)
   class(case_type), intent(inout) :: this
   this%n = 2*this%n
end subroutine
@test(cases=[1, 2, 5])
subroutine below(this)
   class(case_type), intent(inout) :: this
   @assertLessThan(this%n, 10)
end subroutine
@test(testParameters={[new_number(3), new_number(4)]})
subroutine even(this)
   class(case_type), intent(inout) :: this
   @assertEqual(0, mod(this%n, 2))
end subroutine
end module test_x
"""


def test_parametrised_tests_run_once_per_parameter(tmp_path, runtime):
    status, output = run(tmp_path, runtime, PARAMETRISED)
    assert status == 2
    assert "failure in below[5]\n   expected right > 10, found 10\n" in output
    assert output.endswith("FAILED (5 tests, 1 failures)\n")


GOOD = module("@assertTrue(.true.)")


@pytest.mark.parametrize("old, new, why", [
    ("module test_x\n", "module test_y\n", "must open with `module test_x`"),
    ("module test_x\n", "module test_x ! of x\n", "no comment behind the module"),
    ("use funit\n", "", "`use funit` is missing"),
    ("end module test_x", "end module test_x\nmodule y\nend module y", "one module per file"),
    ("end module test_x", "end module test_x\nsubroutine y\nend subroutine", "nothing may follow"),
    ("@test\n", "", "has no @test"),
    ("@test\n", "@test ! it\n", "no comment behind an annotation"),
    ("@test\n", "@test\n@test\n", "still waits"),
    ("@test\n", "@disable\n@test\n", "@disable stands between"),
    ("@test\n", "@test(npes=[1])\n", "takes cases and testParameters only"),
    ("@test\n", "@test(cases=[-1])\n", "not of the form"),
    ("@test\n", "@test(cases=[1])\n", "only with @testParameter"),
    ("@test\n", "@mpiTest\n", "unknown annotation @mpiTest"),
    ("@test\n", "@parameters(x)\n", "unknown annotation"),
    ("@test\n", "@before\n", "has no @test"),
    ("t1()\n@", "t1() ! comment\n@", "nothing behind it"),
    ("t1()", "t1(this)", "takes (this) with @testCase"),
    ("t1()", "t" * 44 + "()", "at most 43 characters"),
    ("@assertTrue(.true.)", "if (.true.) @assertTrue(.true.)", "its line to itself"),
    ("@assertTrue(.true.)", "@assertTrue(.true.) ! yes", "no comment behind"),
    ("@assertTrue(.true.)", "@assertTrue(.true., &\n 'x')", "one line, without &"),
    ("@assertTrue(.true.)", "@assertTrue(.true.", "brackets closed"),
    ("@assertTrue(.true.)", "@assertTrue", "needs parentheses"),
    ("@assertTrue(.true.)", "@assertTrue()", "takes 1 positional"),
    ("@assertTrue(.true.)", "@assertEqual(1)", "takes 2 positional"),
    ("@assertTrue(.true.)", "@assertEqual(expected=1, found=1)", "takes 2 positional"),
    ("@assertTrue(.true.)", "@assertEqual(1, 1, 'x')", "by keyword"),
    ("@assertTrue(.true.)", "@assertEqual(1, 1, tol=1)", "allowed keywords"),
    ("@assertTrue(.true.)", "@assertLessThan(1, 1, tolerance=1)", "allowed keywords"),
    ("@assertTrue(.true.)", "@assertEqual(1, , 1)", "empty argument"),
    ("@assertTrue(.true.)", "@assertRelativelyEqual(1.0, 1.0)", "needs a tolerance"),
    ("@assertTrue(.true.)", "@assertExceptionRaised", "needs parentheses"),
    ("@assertTrue(.true.)", "@assertIsInfinite(1.0)", "unknown annotation @assertIsInfinite"),
    ("@assertTrue(.true.)", "@assertIsNotNaN(1.0)", "unknown annotation @assertIsNotNaN"),
    ("@assertTrue(.true.)", "@assertEquivalent(a, b)", "unknown annotation"),
    ("end module test_x", "@test\nend module test_x", "needs a line `subroutine"),
])
def test_what_pfunit_refuses_is_refused(tmp_path, old, new, why):
    assert old in GOOD
    result = preprocess(tmp_path, GOOD.replace(old, new, 1))
    assert result.returncode == 1
    assert why in result.stderr
    assert result.stderr.startswith("test_x.pf:")


@pytest.mark.parametrize("old, new, why", [
    ("@test(cases=[1, 2, 5])", "@test", "exactly one of cases"),
    ("@testCase(constructor=new_case)", "@testCase", "needs @testCase(constructor=...)"),
    ("@testParameter(constructor=new_number)", "@testParameter", "cases need @testParameter"),
    ("@testCase(constructor=new_case)", "@testCase(constructor=new_case, testParameters={p()})",
     "exactly one of cases"),
    ("@test(cases=[1, 2, 5])", "@test(cases=[1, 2, 5])\n@disable", "for plain tests"),
    ("subroutine below(this)", "subroutine below()", "takes (this) with @testCase"),
    ("@test(cases=[1, 2, 5])", "@before\nsubroutine b()\nend subroutine\n@test(cases=[1, 2, 5])",
     "do not go with @testCase"),
    (":: case_type\n", ":: case_type ! fixture\n", "nothing behind it"),
])
def test_what_pfunit_refuses_in_parametrised_tests_is_refused(tmp_path, old, new, why):
    assert old in PARAMETRISED
    result = preprocess(tmp_path, PARAMETRISED.replace(old, new, 1))
    assert result.returncode == 1
    assert why in result.stderr


@pytest.mark.parametrize("call", [
    "call assertEqual(1.0_real64, 1.0)",       # single found, double expected
    "call assertEqual(1.0, 1)",
    "call assertNotEqual('a', 'b')",           # pFUnit has no such overload
    "call assertTrue(reshape([.true.], [1, 1]))",
    "call assertIsNaN([1.0])",
])
def test_what_pfunit_does_not_overload_does_not_compile(tmp_path, runtime, call):
    made = preprocess(tmp_path, module(call))
    assert made.returncode == 0
    built = subprocess.run(["gfortran", *FLAGS, f"-I{runtime}", "-c", "test_x.F90"],
                           cwd=tmp_path, capture_output=True, text=True, check=False)
    assert built.returncode != 0
    assert "test_x.pf" in built.stderr  # the compiler points at the .pf file
