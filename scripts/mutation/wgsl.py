"""Which text of a WGSL file may be changed: statements and constants, but neither comments nor declarations.

A scan of characters, as the linker's own: the shaders' style (spaces around operators, none inside `<>` of a type) is relied upon.
"""

import re

# Type names that open a template list.
TEMPLATE = re.compile(r"\b(?:array|atomic|ptr|bitcast|vec[234]|mat[234]x[234]|var)<")
# Items at module scope that are left as they are. Their heads are declarations that Rust code must match.
DECLARATION = re.compile(r"\s*(?:override|enable|diagnostic|requires|alias|var)\b")
ATTRIBUTE = re.compile(r"@\w+(?:\([^)]*\))?")


def without_comment(line):
    """The line up to its comment."""
    return line.split("//", 1)[0]


def is_code(line):
    """Has the line more than a comment and brackets?"""
    return bool(re.search(r"\w", without_comment(line)))


def _blank(text, begin, end):
    return text[:begin] + " " * (end - begin) + text[end:]


def _without_templates(line):
    """Blanks `<...>` behind the name of a type; a template list contains no parentheses."""
    at = 0
    while True:
        found = TEMPLATE.search(line, at)
        if not found:
            return line
        depth, end = 1, found.end()
        while end < len(line) and depth > 0:
            depth += {"<": 1, ">": -1}.get(line[end], 0)
            end += 1
        line = _blank(line, found.end() - 1, end)
        at = end


def _without_step_of_loop(line):
    """Blanks the third clause of `for (a; b; c)`: without its step a loop does not end, which any run detects by its timeout."""
    found = re.search(r"\bfor \(", line)
    if not found:
        return line
    first = line.find(";", found.end())
    second = line.find(";", first + 1) if first >= 0 else -1
    if second < 0:
        return line
    depth, end = 1, second + 1
    while end < len(line) and depth > 0:
        depth += {"(": 1, ")": -1}.get(line[end], 0)
        end += 1
    return _blank(line, second + 1, end - 1)


def changeable(text):
    """The lines of a file with everything blanked that no mutant changes. Columns are those of the file."""
    lines, masked = text.split("\n"), []
    depth, item = 0, None  # item: the kind of the module-scope item that is open
    in_head = False  # between `fn` and its `{`
    for line in lines:
        code = without_comment(line)
        code = ATTRIBUTE.sub(lambda found: " " * len(found.group()), code)
        shown = _without_step_of_loop(_without_templates(code))
        if depth == 0 and item is None:
            word = re.match(r"\s*(fn|struct|const)\b", code)
            if word:
                item, in_head = word.group(1), word.group(1) == "fn"
            elif DECLARATION.match(code):
                item = "declaration"
        was_struct_or_declaration = item in ("struct", "declaration")
        if in_head:
            opening = code.find("{")
            shown = _blank(shown, 0, len(shown) if opening < 0 else opening + 1)
            in_head = opening < 0
        if was_struct_or_declaration:
            shown = " " * len(shown)
        shown = re.sub(r"\bcase [^:]*:", lambda found: " " * len(found.group()), shown)
        masked.append(shown)
        depth += code.count("{") - code.count("}")
        if depth == 0 and not in_head:
            if item in ("fn", "struct") and "}" in code or item in ("const", "declaration") and ";" in code:
                item = None
    return masked


def closing(text, opening):
    """Index of the bracket that closes the one at `opening`, or -1 where it stands on another line."""
    pairs = {"(": ")", "[": "]", "{": "}"}
    stack = []
    for at in range(opening, len(text)):
        if text[at] in pairs:
            stack.append(pairs[text[at]])
        elif stack and text[at] == stack[-1]:
            stack.pop()
            if not stack:
                return at
    return -1


def arguments(text, opening):
    """Begin and end of each argument of the call whose parenthesis is at `opening`; none where it ends on another line."""
    end = closing(text, opening)
    if end < 0:
        return []
    spans, begin, depth = [], opening + 1, 0
    for at in range(opening + 1, end):
        depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(text[at], 0)
        if text[at] == "," and depth == 0:
            spans.append((begin, at))
            begin = at + 1
    spans.append((begin, end))

    def trimmed(span):
        part = text[span[0] : span[1]]
        return span[0] + len(part) - len(part.lstrip()), span[1] - (len(part) - len(part.rstrip()))

    return [trimmed(span) for span in spans]


def signatures(texts):
    """Types of the parameters of each function and of the members of each struct, by name. Where variants differ, none."""
    found = {}
    for text in texts:
        code = "\n".join(map(without_comment, text.split("\n")))
        for head in re.finditer(r"\b(?:fn (\w+)\s*\(|struct (\w+)\s*\{)", code):
            name, opening = head.group(1) or head.group(2), head.end() - 1
            end = closing(code, opening)
            inside = ATTRIBUTE.sub("", code[opening + 1 : end])
            types = tuple(part.strip().replace(" ", "") for part in re.findall(r":\s*(\w+(?:<[^()]*?>)?)\s*(?:,|$)", inside))
            found[name] = types if found.get(name, types) == types else ()
    return found
