# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the study, made from the CSV files alone. Every cell has a mark, whether the method gains or loses."""

from pathlib import Path

import matplotlib
import tables
from grid import ALBEDOS, DIRECTIONS, GS, TAUS
from walks import BASELINE, GUIDED, ISOTROPIC, UNTABLED

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D

# Colours of Okabe and Ito, which colour-blind readers can tell apart, and a shape for each.
STYLES = {
    ISOTROPIC: ("#0072B2", "o", "scattering walk of isotropic media, guided by tables"),
    GUIDED: ("#D55E00", "^", "transfer walk, guided by tables"),
    "transfer": ("#009E73", "s", "transfer walk, best next events"),
    UNTABLED: ("#CC79A7", "D", "scattering walk, guided by closed forms"),
    "adding": ("#E69F00", "P", "adding walk"),
    BASELINE: ("#000000", "x", "transfer walk, plain"),
}
UNSURE = "#E00000"
BETTER = (ISOTROPIC, GUIDED, "transfer")
RATIO = "Efficiency, 1 / (variance × time), over the plain transfer walk's"
TIME_RATIO = "Time of the plain transfer walk to .1 % standard error over this walk's, its set-up counted"
COST_DIRECTIONS = "60° / 60°, 90°"


def draw_all(docs: Path) -> None:
    """Draws all pictures with available data."""
    drawings = {
        "study-grid": ("grid", lambda rows: draw_grid(rows, "ratio", BETTER, RATIO)),
        "study-time": ("grid", lambda rows: draw_grid(rows, "time_ratio", BETTER, TIME_RATIO)),
        "study-plain": ("grid", lambda rows: draw_grid(rows, "ratio", (UNTABLED,), RATIO)),
        "study-cost": ("grid", draw_cost),
        "study-layers": ("layers", draw_layers),
    }
    for name, (data, draw) in drawings.items():
        if not (docs / "study" / f"{data}.csv").exists():
            continue
        figure = draw(tables.read(data, docs / "study"))
        figure.savefig(docs / f"{name}.png", dpi=100, metadata={"Software": None})
        plt.close(figure)


def draw_grid(rows: list[dict], column: str, methods: tuple, what: str):
    """A panel for each g and albedo; in a panel, cells by tau, with the five pairs of directions side by side."""
    figure, axes = plt.subplots(len(GS), len(ALBEDOS), figsize=(15, 11), sharex=True, sharey=True,
                                layout="constrained")
    shown = [method for method in methods if any(row["method"] == method for row in rows)]
    for line, g in zip(axes, GS, strict=True):
        for panel, albedo in zip(line, ALBEDOS, strict=True):
            inside = [row for row in rows if row["g"] == g and row["albedo"] == albedo]
            for method in shown:
                _cells(panel, [row for row in inside if row["method"] == method], column, method)
            panel.axhline(1.0, color="black", linewidth=1.2)
            _frame(panel)
            panel.set_title(f"g {g:g}, albedo {albedo:g}", fontsize=11)
    for panel in axes[-1]:
        panel.set_xlabel("optical thickness")
    for panel in axes[:, 0]:
        panel.set_ylabel("ratio")
    names = list(DIRECTIONS)
    figure.suptitle(f"{what}\nMarks at one thickness, from the left: {'; '.join(names)}. Lines: medians.",
                    fontsize=12)
    figure.legend(handles=_legend(shown), loc="outside lower center", ncols=3, fontsize=10, frameon=False)
    return figure


def _cells(panel, rows, column, method):
    colour, shape, _ = STYLES[method]
    order = list(DIRECTIONS)
    for row in rows:
        if row.get(column) is None:
            continue
        x = row["tau"] * 1.13 ** (order.index(row["directions"]) - 2)
        panel.plot([x], [row[column]], shape, color=colour, markersize=5, gid="cell", zorder=3)
        if row["status"] != "ok":
            panel.plot([x], [row[column]], "x", color=UNSURE, markersize=8, zorder=4)
    medians = []
    for tau in TAUS:
        values = sorted(row[column] for row in rows if row["tau"] == tau and row.get(column) is not None)
        if values:
            medians.append((tau, values[len(values) // 2]))
    panel.plot(*zip(*medians, strict=True) if medians else ([], []), color=colour, linewidth=1, alpha=0.6, zorder=2)


def _frame(panel):
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.grid(True, which="major", color="0.88", linewidth=0.7)
    panel.set_xticks(TAUS, [f"{tau:g}" for tau in TAUS])
    panel.minorticks_off()


def _legend(methods):
    handles = [Line2D([], [], color=STYLES[m][0], marker=STYLES[m][1], label=STYLES[m][2]) for m in methods]
    handles.append(Line2D([], [], color=UNSURE, marker="x", markersize=8, linestyle="",
                          label="not reliable: one sample has > 10 % of the squares"))
    return handles


def draw_cost(rows: list[dict]):
    """The factors of the ratios: variance, events and time of a sample, for one pair of directions."""
    columns = {"variance": "relative variance of a sample", "events": "events of a sample",
               "cpu_us": "CPU time of a sample, µs"}
    methods = (BASELINE, GUIDED, ISOTROPIC)
    figure, axes = plt.subplots(len(columns), len(GS), figsize=(13, 11), sharex=True, sharey="row",
                                layout="constrained")
    dashes = dict(zip(ALBEDOS, (":", "-.", "--", "-"), strict=True))
    for panel, g in zip(axes[0], GS, strict=True):
        panel.set_title(f"g {g:g}", fontsize=11)
    for line, (column, label) in zip(axes, columns.items(), strict=True):
        line[0].set_ylabel(label)
        for panel, g in zip(line, GS, strict=True):
            for method in methods:
                for albedo in ALBEDOS:
                    found = [row for row in rows if row["method"] == method and row["g"] == g
                             and row["albedo"] == albedo and row["directions"] == COST_DIRECTIONS
                             and row.get(column) is not None]
                    panel.plot([row["tau"] for row in found], [row[column] for row in found], dashes[albedo],
                               color=STYLES[method][0], marker=STYLES[method][1], markersize=4)
            _frame(panel)
    for panel in axes[-1]:
        panel.set_xlabel("optical thickness")
    handles = [Line2D([], [], color=STYLES[m][0], marker=STYLES[m][1], label=STYLES[m][2]) for m in methods]
    handles += [Line2D([], [], color="0.3", linestyle=dashes[a], label=f"albedo {a:g}") for a in ALBEDOS]
    figure.suptitle(f"What a sample costs and brings, {COST_DIRECTIONS}", fontsize=12)
    figure.legend(handles=handles, loc="outside lower center", ncols=4, fontsize=10, frameon=False)
    return figure


def draw_layers(rows: list[dict]):
    """Stacks in strips below each other; in each strip the five pairs of directions, from the top."""
    stacks = list(dict.fromkeys(row["stack"] for row in rows))
    figure, axes = plt.subplots(1, 2, figsize=(13, 0.75 * len(stacks) + 2.2), sharey=True, layout="constrained")
    titles = {"ratio": "Efficiency over the plain transfer walk's",
              "time_ratio": "Time to .1 %, set-up counted: the plain transfer walk's over this"}
    order = list(DIRECTIONS)
    for panel, (column, title) in zip(axes, titles.items(), strict=True):
        for row in rows:
            if row["method"] == BASELINE or row.get(column) is None:
                continue
            colour, shape, _ = STYLES[row["method"]]
            y = stacks.index(row["stack"]) + 0.15 * (order.index(row["directions"]) - 2)
            panel.plot([row[column]], [y], shape, color=colour, markersize=6, gid="cell", zorder=3)
            if row["status"] != "ok":
                panel.plot([row[column]], [y], "x", color=UNSURE, markersize=9, zorder=4)
        for k in range(1, len(stacks)):
            panel.axhline(k - 0.5, color="0.85", linewidth=0.8)
        panel.axvline(1.0, color="black", linewidth=1.2)
        panel.set_xscale("log")
        panel.grid(True, axis="x", which="major", color="0.88", linewidth=0.7)
        panel.set_title(title, fontsize=11)
        panel.set_xlabel("ratio")
    axes[0].set_yticks(range(len(stacks)), stacks)
    axes[0].set_ylim(len(stacks) - 0.5, -0.5)
    figure.suptitle(f"In each strip, from the top: {'; '.join(order)}", fontsize=10)
    figure.legend(handles=_legend(("adding", "transfer")), loc="outside lower center", ncols=3, fontsize=10,
                  frameon=False)
    return figure
