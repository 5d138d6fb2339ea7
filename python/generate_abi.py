"""Writes `src/jcas/_abi.py`, the ctypes declarations, from `include/jcas.h`.

    python python/generate_abi.py [--check]

The header is regular, as cbindgen writes it, so a few patterns read all of it; what they do not know they
refuse. With --check nothing is written and the exit status says whether the file is fresh.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

HERE = Path(__file__).parent
HEADER = HERE.parent / "include" / "jcas.h"
TARGET = HERE / "src" / "jcas" / "_abi.py"

SCALARS = {
    "int32_t": "c_int32",
    "int64_t": "c_int64",
    "jcas_status": "c_int32",
    "jcas_run_tasks": "c_void_p",
    "jcas_write": "c_void_p",
    "uint8_t": "c_uint8",
    "uint32_t": "c_uint32",
    "uint64_t": "c_uint64",
    "size_t": "c_size_t",
    "float": "c_float",
    "double": "c_double",
}

PREAMBLE = '''"""The C interface as ctypes sees it. Generated from include/jcas.h by generate_abi.py: do not edit."""

from __future__ import annotations

from ctypes import (
    CDLL,
    POINTER,
    Structure,
    c_char_p,
    c_double,
    c_int32,
    c_int64,
    c_size_t,
    c_uint32,
    c_uint64,
    c_void_p,
)

'''


def main() -> int:
    """Write the declarations, or check that they are fresh."""
    text = generate(HEADER.read_text(encoding="utf-8"))
    if "--check" in sys.argv[1:]:
        fresh = TARGET.is_file() and TARGET.read_text(encoding="utf-8") == text
        if not fresh:
            print(f"{TARGET} is not what {HEADER} gives: run python/generate_abi.py", file=sys.stderr)
        return 0 if fresh else 1
    TARGET.write_text(text, encoding="utf-8")
    return 0


def generate(header: str) -> str:
    """Turn the header's text into the module's."""
    code = re.sub(r"/\*.*?\*/|//[^\n]*", "", header, flags=re.DOTALL)
    constants = {
        name: int(value.strip("()"))
        for name, value in re.findall(r"^#define (JCAS_\w+) (\(?-?\d+\)?)$", code, flags=re.MULTILINE)
    }
    code = re.sub(r"\bJCAS_(?:API|NODISCARD)\b\s*", "", code)
    code = re.sub(r"^\s*#.*$", "", code, flags=re.MULTILINE).replace('extern "C" {', "")
    structs = dict(re.findall(r"typedef struct (\w+) \{(.*?)\} \1;", code, flags=re.DOTALL))
    functions = re.findall(r"^([\w ]+?[ *]+)(jcas_\w+)\(([^)]*)\);", code, flags=re.MULTILINE)
    parts = [PREAMBLE]
    parts += [f"{name} = {value}\n" for name, value in constants.items()]
    for name, body in structs.items():
        parts.append(_struct(name, body, constants, structs))
    parts.append("\n\ndef declare(library: CDLL) -> None:\n")
    parts.append('    """Give every function its types."""\n')
    for returns, name, arguments in functions:
        parts.append(_function(returns.strip(), name, arguments, structs))
    return "".join(parts)


def _struct(name: str, body: str, constants: dict[str, int], structs: dict[str, str]) -> str:
    fields = []
    for declaration in filter(None, (line.strip() for line in body.split(";"))):
        matched = re.fullmatch(r"(?:const )?(?:struct )?(\w+) (\*?)(\w+)(?:\[(\w+)\])?", " ".join(declaration.split()))
        if matched is None:
            raise ValueError(f"{name}: cannot read {declaration!r}")
        kind, pointer, field, count = matched.groups()
        if pointer:
            written = "c_void_p"
        else:
            written = kind if kind in structs else SCALARS[kind]
        if count:
            written += f" * {count if count in constants else int(count)}"
        fields.append(f'        ("{field}", {written}),\n')
    return f"\n\nclass {name}(Structure):\n    _fields_ = (\n{''.join(fields)}    )\n"


def _function(returns: str, name: str, arguments: str, structs: dict[str, str]) -> str:
    kinds = [] if arguments.strip() == "void" else [_argument(part, structs) for part in arguments.split(",")]
    result = "c_char_p" if returns == "const char *" else SCALARS[returns]
    written = ", ".join(kinds) + ("," if len(kinds) == 1 else "")
    return f"    library.{name}.argtypes = ({written})\n    library.{name}.restype = {result}\n"


def _argument(declaration: str, structs: dict[str, str]) -> str:
    matched = re.fullmatch(r"(?:const )?(?:struct )?(\w+) (\**)\w+", " ".join(declaration.split()))
    if matched is None:
        raise ValueError(f"cannot read the argument {declaration!r}")
    kind, stars = matched.groups()
    if stars == "**":
        return "POINTER(c_void_p)"
    if stars == "*":
        if kind == "char":
            return "c_char_p"
        return f"POINTER({kind})" if kind in structs else "c_void_p"
    return SCALARS[kind]


if __name__ == "__main__":
    sys.exit(main())
