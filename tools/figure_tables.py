# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the tables of docs/figures.md from the measurements of `make bench`: python tools/figure_tables.py

Reads build/bench/*.json. If a file is missing, its table is not changed and a message names the file. The accuracy
table is computed here, from tests/data/reference_cases.json.
"""

import json
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BENCH = ROOT / "build/bench"
PAGE = ROOT / "docs/figures.md"


def markdown(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(cells) + " |" for cells in rows]
    return "\n".join(lines)


def percent(value, digits=2):
    return "-" if value is None else f"{100 * value:.{digits}f} %"


def plain(value):
    """Three digits at most, without an exponent."""
    return f"{value:,.0f}" if abs(value) >= 100.0 else f"{value:.2g}"


def accuracy():
    import lamina

    data = json.loads((ROOT / "tests/data/reference_cases.json").read_text(encoding="utf-8"))
    rows = []
    for case in data["cases"]:
        if case["kind"] != "flux" or case.get("ior", 1) != 1:
            continue
        layers = [lamina.Stack.from_json({"schema": 1, "layers": [{"kind": "medium", **layer}]}).layers[0]
                  for layer in case["layers"]]
        solved = lamina.solve(lamina.Stack(layers))
        mu0 = "diffuse" if case["mu0"] == "lambert" else case["mu0"]
        reflected = float(solved.reflectance(mu0)[0])
        diffuse, direct = (float(part[0]) for part in solved.transmittance(mu0, parts=True))
        through = diffuse if case.get("T_is") == "diffuse" else diffuse + direct
        known = [(reflected, case["R"])] + ([(through, case["T"])] if case["T"] is not None else [])
        worst = max(abs(ours - theirs) for ours, theirs in known)
        rows.append([case["id"], case["source"].split(";")[0].split(",")[0], f"{reflected:.6f}",
                     f"{case['R']:.6f}", f"{worst:.1e}"])
    return markdown(["case", "source", "R", "published R", "largest error of R and T"], rows)


def solver(rows):
    timed = [row for row in rows if "cpu_ms" in row]
    return markdown(["code", "CPU time", "times Lamina's", "largest error"],
                    [[row["name"], f"{row['cpu_ms']:.1f} ms", f"{row['times_lamina']:.0f}", percent(row["error"], 3)]
                     for row in timed])


def doubling(rows):
    return markdown(["nodes per hemisphere", "GFlop/s", "matrix products, GFlop/s", "share"],
                    [[str(row["nodes"]), f"{row['join_gflops']:.1f}", f"{row['dgemm_gflops']:.1f}",
                      percent(row["share"], 0)] for row in rows])


def walks(rows):
    head = ["estimate", "to .1 %", "times sooner", "relative variance", "samples/s", "events/s", "2 threads / 1",
            "kernels compiled in"]
    return markdown(head,
                    [[row["name"], f"{row['seconds']:.3g} s", f"{row['times_sooner']:.3g}", f"{row['variance']:.3g}",
                      f"{row['samples_per_second'] / 1e6:.2f} M", _millions(row, "events_per_second"),
                      f"{row['second_thread']:.2f}" if "second_thread" in row else "-",
                      f"{row['compilation']:.1f} s" if "compilation" in row else "-"] for row in rows])


def searchlight(rows):
    return markdown(["stack", "quality", "CPU time", "largest error of a ring", "photons, to the same error",
                     "times sooner"],
                    [[row["name"], row["quality"], f"{plain(row['CPU-s'])} s", percent(row["error"]),
                      f"{plain(row['photons, CPU-s to this error'])} s", plain(row["times sooner"])] for row in rows])


def inverse(rows):
    names = ("albedo", "g", "tau")
    return markdown(["fit", "seconds", "worst", "SciPy over `lamina.solve`", "times sooner",
                     "truth within 2 errors: albedo, g, thickness"],
                    [[row["name"], f"{row['seconds']:.2g} s", f"{row['worst']:.2g} s",
                      f"{row['SciPy over lamina.solve']:.2g} s", plain(row["times sooner"]),
                      ", ".join(percent(row[f"within 2 errors, {name}"], 1) for name in names)
                      if "within 2 errors, g" in row else "-"] for row in rows])


def _millions(row, key):
    return f"{row[key] / 1e6:.1f} M" if key in row else "-"


def voxels(rows):
    return markdown(["walk", "time to 1 % of a texel", "times Lamina's", "relative variance", "paths/s", "mean light"],
                    [[row["name"], f"{plain(row['ms a texel'])} ms", plain(row["times"]),
                      f"{row['relative variance']:.2g}", f"{row['paths/s'] / 1e3:.3g} k", f"{row['value']:.3f}"]
                     for row in rows])


def frames(rows):
    return markdown(["method", "bake", "frame", "break-even, frames"],
                    [[row["name"], f"{plain(row['bake, CPU-s'])} s", f"{plain(row['frame, CPU-s'])} s",
                      str(row.get("break-even, frames") or "-")] for row in rows])


def portal(rows):
    head = ["medium", "mean free path", "rms", "energy", "rms, Random Walk", "energy, Random Walk",
            "time / Random Walk", "variance at equal time / Random Walk"]
    return markdown(head, [[row["medium"], f"{row['mean free path']:g}",
                            percent(row["rms"], 1) if row["rms"] > 0.0 else "below the noise",
                            percent(row["energy"], 1), percent(row["rms, Random Walk"], 0),
                            percent(row["energy, Random Walk"], 0), f"{row['time']:.2f}",
                            plain(row["variance at equal time"])] for row in rows])


def bake(rows):
    return markdown(["stack", "quality", "time", "fit error", "closures"],
                    [[row["stack"], row["quality"], f"{row['ms']:.0f} ms", percent(row.get("fit_error")),
                      str(row.get("closures", "-"))] for row in rows])


def fit(rows):
    return markdown(["basis", "stacks", "mean", "worst slice", "albedo", "transmission", "its worst slice", "closures"],
                    [[row["basis"], row["stack"], percent(row["mean"]), percent(row["worst"]),
                      f"{row['albedo']:.0e}", percent(row["transmission"], 1),
                      percent(row["worst_transmission"], 1), f"{row['closures']:.1f}"]
                     for row in rows if row["blind"] is None and row["quality"] == "final"])


def dust(rows):
    def number(row, key, form):
        return format(row[key], form) if key in row else "-"

    return markdown(["mesh", "settling, Mrays/s", "bare Embree, Mrays/s", "share", "seconds", "peak memory"],
                    [[row["name"], number(row, "settling, Mrays/s", ".2f"), number(row, "bare Embree, Mrays/s", ".2f"),
                      percent(row.get("settling/bare"), 0), number(row, "seconds", ".1f"),
                      f"{row['peak MiB']:.0f} MiB" if "peak MiB" in row else "-"] for row in rows])


def render(report):
    rows = report["rows"]
    return markdown(["material", "closures", "time / Principled", "noise at equal samples",
                     "time at equal noise / Principled"],
                    [[row["material"], str(row.get("closures", "-")), f"{row['time_over_principled']:.2f}",
                      percent(row["noise"], 1), f"{row['time_to_equal_noise_over_principled']:.2f}"] for row in rows])


TABLES = {"solver": solver, "doubling": doubling, "walks": walks, "searchlight": searchlight, "inverse": inverse,
          "voxels": voxels, "frames": frames, "portal": portal, "bake": bake, "fit": fit, "dust": dust,
          "render": render}


def main():
    text = PAGE.read_text(encoding="utf-8")
    tables = {"accuracy": accuracy()}
    for name, make in TABLES.items():
        path = BENCH / f"{name}.json"
        if path.exists():
            tables[name] = make(json.loads(path.read_text(encoding="utf-8")))
        else:
            print(f"figures: {path} is missing: its table stays as it is; `make bench` measures it", file=sys.stderr)
    for name, table in tables.items():
        pattern = rf"(<!-- table:{name} -->\n).*?(<!-- end -->)"
        text, count = re.subn(pattern, lambda m, t=table: m[1] + t + "\n" + m[2], text, flags=re.DOTALL)
        if count != 1:
            print(f"figures: {PAGE.name} has no place for the table {name}", file=sys.stderr)
            return 1
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
