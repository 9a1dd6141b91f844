"""The module `funit`: one specific procedure per type and rank for each assertion of the stand-in.

Every one of them only copies its arguments into rank-1 arrays of the widest kind and calls a kernel of funit_lite.
"""

MAX_RANK = 3
REALS = {"r64": "real(real64)", "r32": "real(real32)"}
INTEGERS = {"i32": "integer(int32)", "i64": "integer(int64)"}
COMPARISONS = {
    "assertLessThan": "<",
    "assertLessThanOrEqual": "<=",
    "assertGreaterThan": ">",
    "assertGreaterThanOrEqual": ">=",
}


def shape_of(rank):
    """The declaration suffix of an assumed-shape array."""
    return "(" + ",".join(":" * rank) + ")" if rank else ""


def specific(name, declarations, body):
    """One module procedure; every one ends with the optional message and location."""
    dummies = ", ".join(dummy for dummy, _ in declarations)
    return [
        f"subroutine {name}({dummies}, message, location)",
        *[f"{kind}, intent(in) :: {dummy}{shape}" for dummy, (kind, shape) in declarations],
        "character(*), intent(in), optional :: message",
        "type(SourceLocation), intent(in), optional :: location",
        f"call {body}, &",
        "message, location)",
        f"end subroutine {name}",
    ]


def pairs():
    """Ranks of (left, right): equal, or a scalar on the left."""
    for rank in range(MAX_RANK + 1):
        for left in sorted({0, rank}):
            yield left, rank


def equal_reals(procedures):
    """assertEqual for real actual values: expected of three kinds, without tolerance or with one of two kinds."""
    names = []
    for left, rank in pairs():
        for tag, kind in {**REALS, "i32": "integer(int32)"}.items():
            for tolerance in ("", "r64", "r32"):
                name = f"equal_{tag}{left}_r{rank}{tolerance}"
                declarations = [("expected", (kind, shape_of(left))), ("actual", ("real(real64)", shape_of(rank)))]
                bound = "0.0_real64"
                if tolerance:
                    declarations.append(("tolerance", (REALS[tolerance], "")))
                    bound = "real(tolerance, real64)"
                values = "[real(expected, real64)], shape(expected), [actual], shape(actual)"
                procedures += specific(name, declarations, f"check_real_equal({values}, {bound}")
                names.append(name)
    return names


def equal_others(procedures):
    """assertEqual for integers, logicals and strings."""
    names = []
    for left, rank in pairs():
        for expected, actual in (("i32", "i32"), ("i32", "i64"), ("i64", "i64")):
            name = f"equal_{expected}{left}_{actual}_{rank}"
            declarations = [("expected", (INTEGERS[expected], shape_of(left))), ("actual", (INTEGERS[actual], shape_of(rank)))]
            values = "[int(expected, int64)], shape(expected), [int(actual, int64)], shape(actual)"
            procedures += specific(name, declarations, f"check_integer_equal({values}")
            names.append(name)
        name = f"equal_l{left}_l{rank}"
        declarations = [("expected", ("logical", shape_of(left))), ("actual", ("logical", shape_of(rank)))]
        procedures += specific(name, declarations, "check_logical_equal([expected], shape(expected), [actual], shape(actual)")
        names.append(name)
    declarations = [("expected", ("character(*)", "")), ("found", ("character(*)", ""))]
    procedures += specific("equal_string", declarations, "check_string_equal(expected, found")
    return [*names, "equal_string"]


def comparisons(procedures, assertion, operator):
    """One of the four comparisons."""
    names = []
    for left, rank in pairs():
        stem = f"{assertion[6:].lower()}_{left}_{rank}"
        values = f"'{operator}', [lhs], shape(lhs), [rhs], shape(rhs)"
        declarations = [("lhs", ("real(real64)", shape_of(left))), ("rhs", ("real(real64)", shape_of(rank)))]
        procedures += specific(f"{stem}_r", declarations, f"check_real_order({values}, 0.0_real64")
        declarations.append(("tolerance", ("real(real64)", "")))
        procedures += specific(f"{stem}_rt", declarations, f"check_real_order({values}, tolerance")
        names += [f"{stem}_r", f"{stem}_rt"]
        for tag, kind in INTEGERS.items():
            declarations = [("lhs", (kind, shape_of(left))), ("rhs", (kind, shape_of(rank)))]
            values = f"'{operator}', [int(lhs, int64)], shape(lhs), [int(rhs, int64)], shape(rhs)"
            procedures += specific(f"{stem}_{tag}", declarations, f"check_integer_order({values}")
            names.append(f"{stem}_{tag}")
    return names


def relatively_equal(procedures):
    """assertRelativelyEqual: the tolerance is required."""
    names = []
    for left, rank in pairs():
        name = f"relative_{left}_{rank}"
        declarations = [("expected", ("real(real64)", shape_of(left))), ("actual", ("real(real64)", shape_of(rank)))]
        declarations.append(("tolerance", ("real(real64)", "")))
        values = "[expected], shape(expected), [actual], shape(actual), tolerance"
        procedures += specific(name, declarations, f"check_real_relative({values}")
        names.append(name)
    return names


def funit_module():
    """The lines of the whole module."""
    procedures = []
    generics = {"assertEqual": equal_reals(procedures) + equal_others(procedures)}
    for assertion, operator in COMPARISONS.items():
        generics[assertion] = comparisons(procedures, assertion, operator)
    generics["assertRelativelyEqual"] = relatively_equal(procedures)
    lines = ["module funit", "use, intrinsic :: iso_fortran_env, only: int32, int64, real32, real64", "use funit_lite"]
    lines += ["implicit none (type, external)", "public"]
    for generic, names in generics.items():
        lines += [f"private :: {name}" for name in names]
        lines += [f"interface {generic}", *[f"module procedure :: {name}" for name in names], f"end interface {generic}"]
    lines += ["private :: int32, int64, real32, real64", "contains", *procedures, "end module funit"]
    return lines
