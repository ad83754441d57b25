"""The mutation operators: each reads one line of changeable text and returns edits (begin, end, replacement)."""

import re

from . import wgsl

# Word, as it stands between spaces, and what replaces it.
INFIX = {
    "compare": {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="},
    "arithmetic": {"+": "-", "-": "+", "*": "+", "/": "*", "%": "/"},
    "assignment": {"+=": "-=", "-=": "+=", "*=": "+=", "|=": "&=", "&=": "|=", "^=": "|="},
    "bits": {"&": "|", "|": "&", "^": "|"},
    "shift": {">>": "<<", "<<": ">>"},
    "logic": {"&&": "||", "||": "&&"},
}

# A call of the first name becomes one of the second; of "" the parentheses stay.
CALLS = {
    "min": "max", "max": "min", "atomicMin": "atomicMax", "atomicMax": "atomicMin", "atomicAdd": "atomicMax", "atomicOr": "atomicAnd",
    "floor": "ceil", "ceil": "floor", "round": "floor", "all": "any", "any": "all", "sin": "cos", "cos": "sin", "abs": "", "normalize": "",
    "fract": "floor", "sqrt": "", "countLeadingZeros": "countTrailingZeros", "firstLeadingBit": "firstTrailingBit",
}  # fmt: skip

# Calls whose result does not depend on the order of the first two arguments.
SYMMETRIC = {
    "min", "max", "dot", "distance", "select", "all", "any", "fixed_umul", "fixed_add", "fixed_mul", "softfloat_add", "softfloat_multiply",
    "lattice_pair",
}  # fmt: skip


def infix(words, code):
    for word, other in words.items():
        for found in re.finditer(r"(?<= )" + re.escape(word) + r"(?= |$)", code):
            # Without an operand on its left, it is a sign.
            if code[: found.start()].strip():
                yield found.start(), found.end(), other


def calls(code):
    for found in re.finditer(r"\b(\w+)\(", code):
        other = CALLS.get(found.group(1))
        if other is not None:
            yield found.start(1), found.end(1), other


def constants(code):
    """Whole numbers ±1 and ×2, floats ×2; 0 becomes 1."""
    for found in re.finditer(r"(?<![\w.])(0x[0-9a-fA-F]+|\d+\.\d*(?:e-?\d+)?|\d+e-?\d+|\d+)([iufh]?)(?![\w.])", code):
        digits, suffix = found.groups()
        if digits.startswith("0x"):
            values = [f"{int(digits, 16) ^ 1:#x}"]
        elif "." in digits or "e" in digits:
            value = float(digits)
            values = ["1.0"] if value == 0.0 else [repr(2.0 * value), repr(0.5 * value)]
        else:
            value = int(digits)
            values = [str(value + 1)] + ([str(value - 1)] if value > 0 else []) + ([str(2 * value)] if value > 2 else [])
        for other in values:
            if other != digits:
                yield found.start(), found.end(), other + suffix


def booleans(code):
    for found in re.finditer(r"\b(true|false)\b", code):
        yield found.start(), found.end(), "false" if found.group() == "true" else "true"


def conditions(code):
    """`if a {` becomes `if !(a) {`."""
    found = re.search(r"\bif (.+?) \{", code)
    if found:
        yield found.start(1), found.end(1), f"!({found.group(1)})"


def select_arms(code):
    for found in re.finditer(r"\bselect\(", code):
        spans = wgsl.arguments(code, found.end() - 1)
        if len(spans) == 3:
            yield from _swapped(code, spans[0], spans[1])


# Functions of the language whose result depends on the order of their arguments; equal numbers mark arguments of one type. The first two of
# clamp(e, low, high), which is min(max(e, low), high), may be exchanged.
ORDERED = {
    "mix": (0, 0, 1), "clamp": (0, 1, 1), "cross": (0, 0), "step": (0, 0), "smoothstep": (0, 0, 0), "pow": (0, 0), "atan2": (0, 0), "reflect": (0, 0),
}  # fmt: skip


def swapped_arguments(code, signatures):
    """Neighboring arguments of the same type, as far as the heads of functions and structs tell."""
    for found in re.finditer(r"\b(\w+)\(", code):
        name = found.group(1)
        spans = wgsl.arguments(code, found.end() - 1)
        types = ORDERED.get(name) or signatures.get(name, ())
        if re.fullmatch(r"(?:vec[234]|mat[234]x[234])[uifh]?", name):
            types = [0] * len(spans)
        if name in SYMMETRIC or len(types) != len(spans):
            continue
        for at in range(len(spans) - 1):
            if types[at] == types[at + 1]:
                yield from _swapped(code, spans[at], spans[at + 1])


def _swapped(code, first, second):
    a, b = code[first[0] : first[1]], code[second[0] : second[1]]
    if a and b and a != b:
        yield first[0], second[1], b + code[first[1] : second[0]] + a


def indices(code):
    """`[i]` becomes `[i + 1u]`; that of a literal is a constant."""
    for found in re.finditer(r"\w\[", code):
        opening = found.end() - 1
        end = wgsl.closing(code, opening)
        inner = code[opening + 1 : end] if end > 0 else ""
        if inner.strip() and not re.fullmatch(r"\d+u?", inner):
            yield opening + 1, end, f"{inner} + 1u"


SWIZZLES = {"x": "y", "y": "x", "z": "x", "w": "x", "xy": "yx", "zw": "wz", "xz": "zx", "xyz": "zyx", "yz": "zy"}


def swizzles(code):
    for found in re.finditer(r"(?<=[\w\])])\.([xyzw]{1,4})\b", code):
        other = SWIZZLES.get(found.group(1))
        if other:
            yield found.start(1), found.end(1), other


def signs(code):
    """`-a` and `!a` become `a`, `~a` too."""
    for found in re.finditer(r"(?:(?<=[(\[])|(?<=[,=*/+<>&|?] )|(?<=return )|(?<=if ))[-!~](?=[\w(])", code):
        yield found.start(), found.end(), ""


STATEMENT = re.compile(r"\s*(?!let\b|var\b|const\b|return\b|break\b|discard\b|if\b|for\b|\})\w.*;\s*$")
GUARD = re.compile(r"\s*if .+ \{ (?:return\b[^;]*|continue); \}\s*$")
BARRIER = re.compile(r"\s*\w*[bB]arrier\(\);\s*$")


def _is_whole(code):
    return code.count("(") == code.count(")") and code.count("{") == code.count("}")


def dropped_statements(code):
    """Assignments, atomics and calls on a line of their own."""
    if STATEMENT.match(code) and _is_whole(code) and not BARRIER.match(code):
        yield len(code) - len(code.lstrip()), len(code.rstrip()), ""


def dropped_guards(code):
    """`if a { return; }` or `{ continue; }` on one line."""
    if GUARD.match(code) and _is_whole(code):
        yield len(code) - len(code.lstrip()), len(code.rstrip()), ""


def dropped_barriers(code):
    if BARRIER.match(code):
        yield len(code) - len(code.lstrip()), len(code.rstrip()), ""


def _of(words):
    return lambda code: infix(words, code)


OPERATORS = {
    **{name: _of(words) for name, words in INFIX.items()},
    "call": calls,
    "constant": constants,
    "boolean": booleans,
    "negate": conditions,
    "select": select_arms,
    "arguments": swapped_arguments,
    "index": indices,
    "swizzle": swizzles,
    "sign": signs,
    "drop-statement": dropped_statements,
    "drop-guard": dropped_guards,
    "drop-barrier": dropped_barriers,
}


def edits(code, signatures):
    """Every edit of one line: operator, begin, end, replacement. `signatures` is that of `wgsl.signatures`."""
    for name, operator in OPERATORS.items():
        found = operator(code, signatures) if operator is swapped_arguments else operator(code)
        for begin, end, replacement in found:
            yield name, begin, end, replacement
