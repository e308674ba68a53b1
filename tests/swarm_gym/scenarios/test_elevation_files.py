"""Elevation models: what is read from ESRI ASCII grids, SRTM tiles and GeoTIFF, and what is refused."""

import re

import numpy as np
import pytest

from helpers.terrain_files import hill, write_asc, write_hgt
from swarm_gym.errors import ScenarioError
from swarm_gym.scenarios.formats.elevation_files import read_elevation
from swarm_gym.scenarios.formats.geographic import GEOGRAPHIC, PLANE, PlaneSystem


def test_a_grid_is_read_from_south_to_north(tmp_path):
    found = read_elevation(write_asc(tmp_path / "a.asc", hill()))
    assert np.array_equal(found.heights, hill())
    assert (found.origin, found.spacing, found.kind) == ((1025.0, 2025.0), (50.0, 50.0), PLANE)
    assert found.box == (1025.0, 2025.0, 1025.0 + 80 * 50.0, 2025.0 + 60 * 50.0)


def test_centres_of_cells_are_taken_as_they_are(tmp_path):
    found = read_elevation(write_asc(tmp_path / "a.asc", hill(), key="center"))
    assert found.origin == (1000.0, 2000.0)


def test_heights_between_posts_are_bilinear_and_gaps_are_not_filled(tmp_path):
    found = read_elevation(write_asc(tmp_path / "a.asc", hill(), gaps=[(10, 20)]))
    x, y = 1025.0 + 50.0 * 30.25, 2025.0 + 50.0 * 40.5
    low, high = hill()[40, 30:32], hill()[41, 30:32]
    expected = 0.5 * (0.75 * low[0] + 0.25 * low[1]) + 0.5 * (0.75 * high[0] + 0.25 * high[1])
    beside_gap, outside = [1025.0 + 50.0 * 19.5, 2025.0 + 50.0 * 10.0], [0.0, 0.0]
    heights = found.at(np.array([[x, y], beside_gap, outside]))
    assert heights[0] == pytest.approx(expected, abs=1e-9)
    assert np.isnan(heights[1:]).all()


@pytest.mark.parametrize("ending", [".prj", ".PRJ"])
def test_small_cells_in_range_are_degrees_and_a_prj_file_says_more(tmp_path, ending):
    pytest.importorskip("pyproj", reason="needs the extra `terrain`")
    import pyproj

    path = write_asc(tmp_path / "a.asc", hill(), cell=0.001, corner=(7.0, 46.0))
    assert read_elevation(path).kind == GEOGRAPHIC
    (tmp_path / f"a{ending}").write_text(pyproj.CRS("EPSG:32632").to_wkt())
    assert read_elevation(path).kind == PLANE


@pytest.mark.parametrize("system", ["EPSG:32632+6360", "EPSG:4326+6360"])
def test_heights_in_feet_are_refused(tmp_path, system):
    pytest.importorskip("pyproj", reason="needs the extra `terrain`")
    import pyproj

    path = write_asc(tmp_path / "a.asc", hill(), cell=0.001, corner=(7.0, 46.0))
    (tmp_path / "a.prj").write_text(pyproj.CRS(system).to_wkt())
    with pytest.raises(ScenarioError, match=r"heights in metres, .* has US survey foot"):
        read_elevation(path)


@pytest.mark.parametrize("ends", [b"\n", b"\r\n", b"\r"])
def test_a_grid_may_begin_with_a_mark_and_end_its_lines_in_any_way(tmp_path, ends):
    path = write_asc(tmp_path / "a.asc", hill())
    expected = read_elevation(path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", ends))
    found = read_elevation(path)
    assert np.array_equal(found.heights, expected.heights)
    assert found.origin == expected.origin


def test_a_tile_has_the_place_of_its_name(tmp_path):
    found = read_elevation(write_hgt(tmp_path, gap=(3, 4)))
    assert (found.origin, found.kind) == ((7.0, 46.0), GEOGRAPHIC)
    assert found.box == pytest.approx((7.0, 46.0, 8.0, 47.0))
    assert (found.heights[0, 0], found.heights[1200, 1200]) == (200, 200 + 1200 + 120)
    assert np.isnan(found.heights[3, 4])
    southern = read_elevation(write_hgt(tmp_path, "s07w072.hgt"))
    assert southern.origin == (-72.0, -7.0)


def write_tif(path, heights, **options):
    rasterio = pytest.importorskip("rasterio", reason="needs the extra `terrain`")
    from rasterio.transform import from_origin

    given = {"crs": "EPSG:32632", "transform": from_origin(500_000, 5_200_000, 30, 30), "nodata": -9999.0}
    given |= {"dtype": "float32", **options}
    rows, columns = heights.shape
    bands = given.pop("bands", 1)
    with rasterio.open(path, "w", "GTiff", columns, rows, bands, **given) as file:
        for band in range(1, bands + 1):
            file.write(heights[::-1].astype(given["dtype"]), band)
        if "units" in options:
            file.units = [options["units"]]
    return path


def test_a_geotiff_is_read_at_the_centres_of_pixels(tmp_path):
    heights = hill()
    heights[5, 6] = -9999.0
    found = read_elevation(write_tif(tmp_path / "a.tif", heights))
    assert np.isnan(found.heights[5, 6])
    assert found.heights[5, 7] == heights[5, 7]
    assert found.origin == (500_015.0, 5_200_000.0 - 15.0 - 60 * 30.0)
    assert found.kind == PLANE
    degrees = PlaneSystem(found.system).to_degrees(np.array([found.origin]))
    assert degrees[0] == pytest.approx([9.0002, 46.937], abs=2e-3)  # zone 32 is centred on 9 degrees east


def test_a_geotiff_in_degrees_is_known_as_such(tmp_path):
    pytest.importorskip("rasterio", reason="needs the extra `terrain`")
    from rasterio.transform import from_origin

    place = from_origin(7.0, 47.0, 0.001, 0.001)
    found = read_elevation(
        write_tif(tmp_path / "a.tiff", hill(), crs="EPSG:4326", transform=place, dtype="int16")
    )
    assert found.kind == GEOGRAPHIC
    assert found.box[3] == pytest.approx(46.9995)
    without = write_tif(tmp_path / "b.tiff", hill(), crs=None, transform=place, dtype="int16")
    assert read_elevation(without).kind == GEOGRAPHIC


def test_the_first_of_several_bands_counts_with_a_warning(tmp_path):
    with pytest.warns(UserWarning, match=r"a\.tif: 3 bands, of which the first is read as heights"):
        found = read_elevation(write_tif(tmp_path / "a.tif", hill(), bands=3))
    assert np.array_equal(found.heights, hill())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"transform": None}, "no place on the earth"),
        ({"transform": (30, 1, 0, 0, -30, 0)}, "the picture is turned"),
        ({"units": "ft"}, "expected heights in metres, got the unit 'ft'"),
        ({"crs": "EPSG:2263"}, "US survey foot"),
        ({"dtype": "complex64", "nodata": None}, "expected real numbers as heights, got complex64"),
    ],
)
def test_other_geotiffs_are_refused(tmp_path, change, message):
    pytest.importorskip("rasterio", reason="needs the extra `terrain`")
    from affine import Affine

    if change.get("transform"):
        change = {"transform": Affine(*change["transform"])}
    elif "transform" in change:
        change = {"transform": Affine.identity()}
    with pytest.raises(ScenarioError, match=message):
        read_elevation(write_tif(tmp_path / "a.tif", hill(), **change))


def test_what_is_no_geotiff_is_refused(tmp_path):
    pytest.importorskip("rasterio", reason="needs the extra `terrain`")
    path = tmp_path / "a.tif"
    path.write_bytes(b"II*\0 and no more")
    with pytest.raises(ScenarioError, match="cannot be read as GeoTIFF"):
        read_elevation(path)


HEAD = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("", "the key ncols is missing"),
        ("P5\n3 2\n255\n", "the key ncols is missing"),
        (HEAD.replace("3", "x"), "ncols must be a number, got 'x'"),
        (HEAD.replace("3", "2.5"), "ncols must be a whole number, got 2.5"),
        (HEAD.replace("3", "0"), "expected 1 to 100,000,000 heights, got 2 rows of 0"),
        (HEAD.replace("3", "1000000000"), "got 2 rows of 1000000000; cut a large file"),
        (HEAD.replace("cellsize 1", "cellsize -1"), "expected a positive cellsize, got -1 x -1"),
        (HEAD.replace("xllcorner 0", "xllcorner nan"), "xllcorner must be finite"),
        (HEAD + "1 2 3\n4 5\n", "expected 2 x 3 = 6 heights, got 5; is the file whole"),
        (HEAD + "1 2 3\n4 5,5 6\n", "expected numbers as heights, got '5,5'"),
        (HEAD + "-9999 " * 6, "no heights; all 6 cells have no data"),
        (HEAD + "nan " * 6, "no heights; all 6 cells have no data"),
        (
            HEAD.replace("nrows 2", "nrows 1") + "1 2 3",
            "expected at least 2 rows and columns of heights, got 1 x 3",
        ),
    ],
)
def test_a_malformed_grid_is_refused_by_value(tmp_path, content, message):
    path = tmp_path / "a.asc"
    path.write_text(content)
    with pytest.raises(ScenarioError, match=re.escape(message)) as raised:
        read_elevation(path)
    assert str(path) in str(raised.value)


@pytest.mark.parametrize(
    ("name", "size", "message"),
    [
        (
            "alps.hgt",
            2 * 1201**2,
            "expected a name that begins with the south-west corner, such as N46E007.hgt",
        ),
        ("N91E007.hgt", 2 * 1201**2, "expected a name that begins with the south-west corner"),
        ("N46E007.hgt", 2 * 1201**2 - 2, "got 2884800; is the file whole"),
        ("N46E007.hgt", 2 * 3601**2 + 2, "got 25934403 or more"),
        ("N46E007.img", 4, "expected an elevation model: .asc, .hgt, .tif, .tiff, got .img"),
    ],
)
def test_a_malformed_tile_is_refused(tmp_path, name, size, message):
    path = tmp_path / name
    path.write_bytes(bytes(size))
    with pytest.raises(ScenarioError, match=re.escape(message)):
        read_elevation(path)


@pytest.mark.parametrize("name", ["a.asc", "N46E007.hgt", "a.tif"])
def test_a_missing_file_is_named(tmp_path, name):
    pytest.importorskip("rasterio", reason="needs the extra `terrain`")
    with pytest.raises(ScenarioError, match=f"{name}: cannot be read.*no such file"):
        read_elevation(tmp_path / name)


@pytest.mark.parametrize("system", ["no system at all", "EPSG:4979+5773"])
def test_an_unknown_reference_system_is_refused(tmp_path, system):
    pytest.importorskip("pyproj", reason="needs the extra `terrain`")
    path = write_asc(tmp_path / "a.asc", hill())
    (tmp_path / "a.prj").write_text(system)
    with pytest.raises(ScenarioError, match="reference system"):
        read_elevation(path)
