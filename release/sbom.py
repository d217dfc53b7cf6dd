# SPDX-License-Identifier: GPL-3.0-or-later
"""The list of what the wheels contain, in the format CycloneDX: python release/sbom.py --output FILE

The components are those of the table "Compiled into the wheel and the extension" of THIRD_PARTY.md. The versions that
this machine knows must be the table's.
"""

import argparse
import re
import tomllib
import uuid
from datetime import UTC, datetime
from pathlib import Path

import origin
from cyclonedx.contrib.license.factories import LicenseFactory
from cyclonedx.model import ExternalReference, ExternalReferenceType, Property, XsUri
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.output.json import JsonV1Dot6
from cyclonedx.schema import SchemaVersion
from cyclonedx.validation.json import JsonStrictValidator

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def rows():
    """[{what, version, licence, ...}] of the table of THIRD_PARTY.md."""
    text = (ROOT / "THIRD_PARTY.md").read_text(encoding="utf-8").partition("## Compiled into")[2].partition("\n## ")[0]
    head, _, *lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines()
                       if line.startswith("|")]
    return [dict(zip(head, line, strict=True)) for line in lines]


def known_versions():
    """Versions by name, of what this machine compiles wheels with."""
    import ziglang

    zig = Path(ziglang.__file__).parent
    number = re.search(r"_LIBCPP_VERSION (\d\d)(\d\d)(\d\d)$", (zig / "lib/libcxx/include/__config").read_text(), re.M)
    header = (zig / "lib/libc/include/any-windows-any/_mingw_mac.h").read_text(encoding="utf-8")
    pins = dict(line.split("==") for name in ("build", "release")
                for line in (ROOT / f"requirements/{name}.txt").read_text(encoding="utf-8").split() if "==" in line)
    embree = re.search(r"^version=(\S+)$", (ROOT / "tools/build_embree.sh").read_text(encoding="utf-8"), re.M)
    mingw = [re.search(rf"__MINGW64_VERSION_{part} (\d+)", header)[1] for part in ("MAJOR", "MINOR", "BUGFIX")]
    return {"libc++, libc++abi and libunwind": ".".join(str(int(part)) for part in number.groups()),
            "mingw-w64": ".".join(mingw), "compiler-rt of zig": pins["ziglang"], "pybind11": pins["pybind11"],
            "Embree": embree[1]}


def bom(components, commit, seconds):
    """The Bom of `components`, rows of the table."""
    licences = LicenseFactory()

    def component(name, version, licence, source, kind=ComponentType.LIBRARY):
        links = [ExternalReference(type=ExternalReferenceType.DISTRIBUTION, url=XsUri(source))] if source else []
        return Component(name=name, version=version, type=kind, licenses=[licences.make_from_string(licence)],
                         external_references=links, bom_ref=name)

    made = Bom(serial_number=uuid.uuid5(uuid.NAMESPACE_OID, commit))
    made.metadata.timestamp = datetime.fromtimestamp(int(seconds), UTC)
    made.metadata.component = component(PROJECT["name"], PROJECT["version"], PROJECT["license"], "")
    made.metadata.properties.add(Property(name="lamina:commit", value=commit))
    parts = [component(row["what"], row["version"], row["licence"], "https://" + row["source"].rpartition("; ")[2])
             for row in components]
    made.components.update(parts)
    made.register_dependency(made.metadata.component, parts)
    return made


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, required=True)
    output = parser.parse_args().output
    components = rows()
    stated = {row["what"]: row["version"] for row in components}
    for name, version in known_versions().items():
        if stated.get(name) != version:
            raise SystemExit(f"release: THIRD_PARTY.md: {name} = {stated.get(name)}: must be {version}")
    text = JsonV1Dot6(bom(components, origin.commit(), origin.date())).output_as_string(indent=1)
    wrong = JsonStrictValidator(SchemaVersion.V1_6).validate_str(text)
    if wrong:
        raise SystemExit(f"release: {output}: {wrong}")
    output.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
