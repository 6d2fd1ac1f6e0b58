# SPDX-License-Identifier: GPL-3.0-or-later
"""Arms of all makers on one wall, of 0.8 m (the smallest arm: 80 mm), so few points that a thousand plans are bearable."""

# Cell, where the part stands, its size, whose programs.
ARMS = (("kr500_r2830", "[2200, 0, 1200], abc_deg: [0, -90, 0]", 10, ("krl", "sinumerik", "linuxcnc")),
        ("ur10e", "[-800, 0, 500], abc_deg: [0, 90, 0]", 1, ("urscript",)),
        ("r2000ic_165f", "[2200, 0, 1200], abc_deg: [0, -90, 0]", 10, ("fanuc",)),
        ("irb6640_185_280", "[2200, 0, 1200], abc_deg: [0, -90, 0]", 10, ("rapid",)))


def small_job(bench, cell, place, size, controllers, name, compensation):
    """The job `name` of the bench: ur10e_pad, `size` times as large, by another cell."""
    path = bench.job("ur10e_pad", [(r"cells/ur10e\.yaml", f"cells/{cell}.yaml"), (r"xyz_mm: .*\}", f"xyz_mm: {place}}}"),
                                   (r"unit: mm", "unit: cm" if size == 10 else "unit: mm"), (r"stepover_mm: 20", f"stepover_mm: {20 * size}"),
                                   (r"spacing_mm: 20", f"spacing_mm: {20 * size}"), (r"programs: .*", f"programs: [{', '.join(controllers)}]")], name)
    with path.open("a", encoding="utf-8") as file:
        file.write(f"\ncompensation: {compensation}\n")
    return path


def cell_with(nominal, name, deviations=""):
    """A copy of a cell beside it, with lines for its arm."""
    text = nominal.read_text(encoding="utf-8")
    assert text.count("\n  joint_stiffness_Nm") == 1
    path = nominal.with_name(name + ".yaml")
    path.write_text(text.replace("\n  joint_stiffness_Nm", "\n" + deviations + "  joint_stiffness_Nm"), encoding="utf-8")
    return path
