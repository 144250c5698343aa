"""Figures for the fault matrix (tests/faults): what was measured of a row's promise, such as "flag" or "recover"."""


def measured(row, what, value, unit):
    print(f"fault matrix: row {row}: {what} {value:.4f} {unit}", flush=True)
