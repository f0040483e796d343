"""Exports of programs for video analysis, made up here in the forms that these write."""

import numpy as np
import pytest

from stickslip import check, load_measurement, load_rig
from stickslip.data import rig_schema
from stickslip.errors import InputError, ParameterError, UnknownNameError

PLANE = {"position": ["x", "y"]}
TIME = np.arange(60) / 60
WAY = np.where(TIME < 0.5, TIME - TIME**2, 0.25)
"""A block that stops after 0.25 m."""


def tilted(way, degrees=3.0, jitter=3e-4, seed=0):
    """Coordinates in the picture (2, n) of a way along a tilted track, away from the origin."""
    angle = np.radians(degrees)
    noise = np.random.default_rng(seed).normal(0.0, jitter, (2, way.size)) if jitter else 0.0
    return np.array([[np.cos(angle)], [np.sin(angle)]]) * way + noise + [[0.1], [-0.05]]


def tracker(points, *, sep="\t", comma=False, above="mass_A", names="t,x,y", blank=(), end=""):
    """What Tracker writes: the name of the track, the header, numbers in powers of ten."""
    lines = [above + end, names.replace(",", sep) + end]
    for row, numbers in enumerate(np.column_stack([TIME[: points.shape[1]], points.T])):
        cells = [f"{number:.9E}" for number in numbers]
        cells = [cells[0], *("" for _ in cells[1:])] if row in blank else cells
        text = sep.join(cells) + end
        lines.append(text.replace(".", ",") if comma else text)
    return "\r\n".join(lines) + "\r\n\r\n\r\n"


@pytest.fixture
def write(tmp_path, monkeypatch):
    """Writes a file into an empty working folder and returns its name."""
    monkeypatch.chdir(tmp_path)

    def writer(text, name="track.txt", encoding="utf-8"):
        (tmp_path / name).write_bytes(text.encode(encoding))
        return name

    return writer


# --- dialects


@pytest.mark.parametrize(
    ("layout", "encoding"),
    [
        ({}, "utf-8"),
        ({"comma": True}, "utf-8"),
        ({"sep": ";", "comma": True}, "utf-8"),
        ({"sep": ","}, "utf-8"),
        ({"end": "\t"}, "utf-8"),
        ({"sep": ",", "above": ",mass A", "end": ","}, "utf-8"),
        ({"above": "Körper_A", "sep": ";", "comma": True}, "utf-8-sig"),
        ({"above": "Körper_A", "sep": ";", "comma": True}, "cp1252"),
    ],
    ids=[
        "tabs",
        "tabs, decimal comma",
        "semicolons, decimal comma",
        "commas",
        "tab at the end",
        "name over its columns",
        "with a byte order mark",
        "from Windows",
    ],
)
def test_exports_of_tracker_are_read_without_preparation(write, layout, encoding):
    file = write(tracker(tilted(WAY, jitter=0), **layout), encoding=encoding)
    record = load_measurement(file, columns=PLANE)
    np.testing.assert_allclose(record.time, TIME, atol=1e-9)
    np.testing.assert_allclose(record.position, WAY, atol=2e-10)  # ten digits were written


def test_units_in_the_header_of_tracker_are_heeded(write):
    file = write(tracker(100 * tilted(WAY, jitter=0), names="t (s),x (cm),y (cm)"))
    np.testing.assert_allclose(load_measurement(file, columns=PLANE).position, WAY, atol=2e-10)


def test_frames_that_were_not_marked_are_gaps(write):
    file = write(tracker(tilted(WAY), blank=(0, 7, 59)))
    with pytest.raises(ParameterError, match=r"column 'x', line 3: .*repair=\"gaps\""):
        load_measurement(file, columns=PLANE)
    record = load_measurement(file, columns=PLANE, repair="gaps")
    assert record.time.size == 57
    assert "dropped 3 non-finite samples" in record.provenance


def test_one_coordinate_is_read_as_it_stands(write):
    points = tilted(WAY)
    record = load_measurement(write(tracker(points)), columns={"position": "x"})
    np.testing.assert_allclose(record.position, points[0], rtol=1e-9)
    assert record.line is None


TWO = "#multi:\n\tmass A\t\tmass B\t\t\nt\tx\ty\tx\ty\t\n" + "".join(
    f"{t}\t{s}\t0.1\t0.1\t{2 * s}\t\n" for t, s in zip(TIME, WAY, strict=True)
)


def test_of_several_tracks_one_must_be_named(write):
    file = write(TWO)
    with pytest.raises(
        InputError, match=r"2 tracks have a column 'x'.*\[\"mass A/x\", \"mass A/y\"\]"
    ):
        load_measurement(file, columns=PLANE)
    with pytest.raises(InputError, match=r"are 't', 'mass A/x', .*\[\"mass A/x\", \"mass A/y"):
        load_measurement(file)
    record = load_measurement(file, columns={"position": ["mass B/x", "mass B/y"]})
    np.testing.assert_allclose(record.position, 2 * WAY, atol=1e-15)
    assert record.line.tilt == pytest.approx(np.pi / 2)


def test_a_column_that_is_not_there_lists_those_that_are(write):
    with pytest.raises(UnknownNameError, match=r"'z'. Known: t, x, y"):
        load_measurement(write(tracker(tilted(WAY))), columns={"position": ["x", "z"]})


def stamp(time):
    return f"0:00:{int(time):02d}:{round(100 * (time % 1)):02d}"


@pytest.mark.parametrize("mark", [".", ","])
def test_blocks_of_kinovea_are_read(write, mark):
    points = 1000 * tilted(WAY[::6], jitter=0)
    rows = [f"{stamp(t)} {x:.6f} {y:.6f} " for t, (x, y) in zip(TIME[::6], points.T, strict=True)]
    text = "\n".join(["#Kinovea Trajectory data export", "#T X Y", *rows, "", ""])
    record = load_measurement(
        write(text.replace(".", mark)), columns=PLANE, units={"position": "mm"}
    )
    np.testing.assert_allclose(record.time, TIME[::6], atol=1e-12)  # whole hundredths
    np.testing.assert_allclose(record.position, WAY[::6], atol=2e-9)


def test_several_blocks_of_kinovea_are_several_tracks(write):
    head = "#Kinovea Trajectory data export\n#T X Y\n\n"
    text = head + "# Block, left\n0 0 5\n40 3 9\n80 6 13\n\n# Lid\n40 1 0\n80 2 0\n120 3 0\n\n"
    file = write(text)
    left = {"position": ["Block, left/X", "Block, left/Y"]}
    with pytest.raises(ParameterError, match=r"row 4: .*repair=\"gaps\""):
        load_measurement(file, columns=left)
    record = load_measurement(
        file, columns=left, units={"time": "ms", "position": "mm"}, repair="gaps"
    )
    np.testing.assert_allclose(record.time, [0, 0.04, 0.08])
    np.testing.assert_allclose(record.position, [0, 5e-3, 10e-3])


@pytest.mark.parametrize(("sep", "mark"), [(",", "."), (",", ","), (";", ",")])
def test_tables_of_kinovea_are_read_with_decimal_commas_in_quotes(write, sep, mark):
    points = 1000 * tilted(WAY, jitter=0)
    lines = [sep.join(f'"{name}"' for name in ("Time", "Track 1/0/X", "Track 1/0/Y"))]
    for t, (x, y) in zip(TIME, points.T, strict=True):
        cells = (f"{number:.6f}".replace(".", mark) for number in (1000 * t, x, y))
        lines.append(sep.join(f'"{cell}"' for cell in cells))
    record = load_measurement(
        write("\r\n".join(lines), "track.csv"),
        columns=PLANE,
        units={"time": "ms", "position": "mm"},
    )
    np.testing.assert_allclose(record.time, TIME, atol=1e-9)
    np.testing.assert_allclose(record.position, WAY, atol=2e-9)


def test_a_comma_that_may_part_thousands_is_no_decimal_comma(write):
    file = write('time,position\n"0","1,592"\n"1","2,000"\n', "data.csv")
    with pytest.raises(ParameterError, match="got '1,592'"):
        load_measurement(file)


def test_a_point_beside_decimal_commas_that_may_part_thousands_is_refused(write):
    file = write("velocity;friction\n0,01;1.500\n0,02;1.700\n", "data.csv")
    with pytest.raises(InputError, match=r"'1\.500' may be 1500 or 1\.500"):
        load_measurement(file)


@pytest.mark.parametrize(
    ("text", "got"),
    [
        ("velocity;friction\n0.01;1,592\n0.02;1,700\n", "'1,592' may be 1592 or 1.592"),
        ("velocity;friction\n1.010;1,592\n1.020;1,700\n", "'1.010' may be 1010 or 1.010"),
        ("velocity;friction\n1,010;1.592\n1,020;1.700\n", "'1,010' may be 1010 or 1.010"),
        ("velocity;friction;n\n0,01;1,5;1.592\n0,02;1,7;1.700\n", ""),
        ("velocity;friction;n\n0.01;1.5;1,592\n0.02;1.7;1,700\n", ""),
        ('velocity,friction,n\n0.01,1.500,"1,592"\n0.02,1.700,"1,700"\n', ""),
        ("velocity;friction;n\n1;1,500;1.592\n2;1,700;1.700\n3;0,900;1.700\n", ""),
    ],
    ids=[
        "read",
        "commas as doubtful as points",
        "points as doubtful as commas",
        "points that nobody reads",
        "commas that nobody reads",
        "commas in quotes that nobody reads",
        "commas that a later number decides",
    ],
)
def test_a_mark_that_may_part_thousands_matters_where_it_is_read(write, text, got):
    file = write(text, "data.csv")
    if got:
        with pytest.raises(InputError, match=f"'(friction|velocity)', line 2: .*{got}: write all"):
            load_measurement(file)
    else:
        np.testing.assert_array_equal(load_measurement(file).friction[:2], [1.5, 1.7])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("#Kinovea Trajectory data export\n#T X Y\n", "has no rows"),
        ("#Kinovea Trajectory data export\n#T X Y\n1 a 2\n", "'X', line 3: .*got 'a'"),
        ("#Kinovea Trajectory data export\n1 1 2\n\na 1 2\n", "begins with 'a', which is not a"),
        ("#Kinovea Trajectory data export\n1 1 2\n1 1 3\n\n1 1 2\n", "'track 1' has the time 1 t"),
        ("mass_A\nt\tx\ty\n", "is not a table: .*commas, semicolons, tabs, bars or blanks"),
        ("t\tx\ty\tx\ty\n0\t1\t2\t3\t4\n", "two columns are named 'x'"),
        ("mass_A\nt\tx\ty\n0\t1\tü\n", "not UTF-8 .byte 0xfc in line 3"),
    ],
)
def test_what_cannot_be_read_gives_one_message_with_its_place(write, text, message):
    with pytest.raises(InputError, match=f"^track.txt: .*{message}"):
        load_measurement(write(text, encoding="cp1252"), columns=PLANE)


def test_stamps_are_times_in_any_table(write):
    file = write("time,position\n0:00:59.50,0\n0:01:00.25,1\n1:00:00.00,2\n", "data.csv")
    np.testing.assert_array_equal(load_measurement(file).time, [59.5, 60.25, 3600.0])


# --- scale, units and settings


@pytest.mark.parametrize("names", ["t,x,y", "t,x (px),y (px)"])
def test_the_gain_of_pixels_is_the_length_of_one(write, names):
    file = write(tracker(2000 * tilted(WAY, jitter=0), names=names))
    record = load_measurement(file, columns=PLANE, gain={"position": 0.5e-3})
    np.testing.assert_allclose(record.position, WAY, atol=1e-9)
    assert record.line.length == pytest.approx(0.25)
    turned = load_measurement(file, columns=PLANE, gain={"position": -0.5e-3})
    np.testing.assert_allclose(turned.position, -record.position)


def test_pixels_have_no_length_of_their_own(write):
    file = write(tracker(tilted(WAY), names="t,x (px),y (px)"))
    with pytest.raises(ParameterError, match=r"not in px; give metres per pixel as gain="):
        load_measurement(file, columns=PLANE)


def test_both_coordinates_have_one_unit(write):
    file = write(tracker(tilted(WAY), names="t,x (cm),y (mm)"))
    with pytest.raises(InputError, match=r"columns 'x .cm.' and 'y .mm.' of the position"):
        load_measurement(file, columns=PLANE)
    record = load_measurement(file, columns=PLANE, units={"position": "cm"})
    assert record.line.length == pytest.approx(0.0025, rel=0.01)  # jitter at both ends


def test_an_angle_has_no_line_of_motion(write):
    file = write("t,x,y\n0,0,0\n1,3,4\n", "data.csv")
    with pytest.raises(InputError, match=r"data.csv: an angle cannot be given as two coordinates"):
        load_measurement(file, columns=PLANE, units={"position": "deg"})


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"position": ["x", "x"]}, "or two different names.*got .'x', 'x'."),
        ({"position": ["x"]}, "or two different names"),
        ({"position": ["x", "y", "t"]}, "or two different names"),
        ({"position": ["x", 2]}, "or two different names"),
        ({"force": ["x", "y"]}, "columns.force must be the name of one column, got"),
    ],
)
def test_only_a_position_has_two_columns(write, columns, message):
    with pytest.raises(InputError, match=message):
        load_measurement(write(tracker(tilted(WAY))), columns=columns)


def test_a_rig_file_names_two_columns(write):
    write(tracker(tilted(WAY)))
    rig = '[mechanism]\ntype = "spring-block"\nmass = 1\n[data]\nfile = "track.txt"\n'
    columns = "columns = {{ position = {} }}\n"
    good = load_rig(write(rig + columns.format('["x", "y"]'), "rig.toml"))
    assert good.measurement.line.length == pytest.approx(0.25, rel=0.01)
    for wrong, words in (('["x"]', "data.columns.position must be"), ("3", "position must be the")):
        with pytest.raises(ParameterError, match=f"^rig.toml: .*{words}"):
            load_rig(write(rig + columns.format(wrong), "rig.toml"))
    write(TWO)
    with pytest.raises(InputError, match=r"columns = \{ position = \[\"mass A/x\", \"mass A/y\"\]"):
        load_rig(write(rig + columns.format('["x", "y"]'), "rig.toml"))


def test_the_schema_of_rig_files_allows_two_columns_and_columns_by_joint():
    columns = rig_schema()["$defs"]["DataTable"]["properties"]["columns"]
    kinds = columns["additionalProperties"]["anyOf"]
    assert [kind["type"] for kind in kinds] == ["string", "array", "object", "number"]
    assert kinds[1]["minItems"] == kinds[1]["maxItems"] == 2


# --- the line of motion


@pytest.mark.parametrize("degrees", [-90, -30, 0, 3, 90, 180, 183])
def test_the_way_is_positive_where_the_body_went_first(write, degrees):
    swing = np.sin(2 * np.pi * TIME) * 0.1
    for way in (WAY, swing):
        file = write(tracker(tilted(way, degrees)))
        record = load_measurement(file, columns=PLANE)
        # Four standard deviations of the jitter of a sample and of the first one.
        np.testing.assert_allclose(record.position, way, atol=4 * np.sqrt(2) * 3e-4)
        wrong = np.degrees(record.line.tilt) - degrees
        assert abs((wrong + 90) % 180 - 90) < 0.2  # jitter over spread and root of 60 is 0.03


def test_a_body_that_recoils_first_goes_forward_all_the_same(write):
    way = 0.2 * TIME / TIME[-1] - 0.03 * np.sin(np.pi * np.minimum(TIME / TIME[9], 1.0))
    record = load_measurement(write(tracker(tilted(way, 10.0))), columns=PLANE)
    assert way[3] < -0.01
    np.testing.assert_allclose(record.position, way, atol=4 * np.sqrt(2) * 3e-4)
    (one,) = check(record).of("line")
    assert str(one).endswith("Positive is the direction of the net travel.")


def test_a_jerk_within_the_jitter_gives_no_direction(write):
    start = np.where(TIME < 0.1, -3e-4, 0.0)
    record = load_measurement(write(tracker(tilted(WAY + start))), columns=PLANE)
    assert record.position[-1] > 0.2


def test_a_straight_motion_says_its_tilt_and_its_jitter(write):
    (found,) = check(load_measurement(write(tracker(tilted(WAY))), columns=PLANE)).of("line")
    assert found.severity == "info"
    assert "a line of 0.25" in found.sentence
    assert found.numbers["across"] == pytest.approx(3e-4, rel=0.3)  # 60 samples: 9 % a sigma
    assert np.degrees(found.numbers["tilt"]) == pytest.approx(3.0, abs=0.1)


def test_a_motion_that_is_not_straight_is_told(write):
    angle = 0.8 * np.sin(2 * np.pi * TIME)
    arc = 0.3 * np.array([np.sin(angle), -np.cos(angle)])
    (found,) = check(load_measurement(write(tracker(arc)), columns=PLANE)).of("line")
    assert found.severity == "warning"
    assert str(found).startswith("The motion is not straight: it deviates by ")
    assert found.numbers["across"] == pytest.approx(0.3 * np.std(np.cos(angle)), rel=1e-6)


@pytest.mark.parametrize(
    "points",
    [tilted(0 * WAY), np.array([np.cos(6.3 * TIME), np.sin(6.3 * TIME)])],
    ids=["at rest", "round and round"],
)
def test_points_that_lie_along_no_line_are_refused(write, points):
    with pytest.raises(InputError, match=r"^track.txt: the two columns .* no motion along a line"):
        load_measurement(write(tracker(points)), columns=PLANE)


def test_times_in_milliseconds_that_pass_for_seconds_are_doubted(write):
    rows = [f"{1000 * t},{s},{s}" for t, s in zip(TIME, WAY, strict=True)]
    file = write("t,x,y\n" + "\n".join(rows) + "\n", "track.csv")
    (found,) = check(load_measurement(file, columns=PLANE)).of("units")
    assert str(found).endswith(
        "check that times are in seconds. If they are in milliseconds, give --unit time=ms."
    )
