"""Special cases of a cloth, one by one: each moves, stays, or ends with an error that names it."""

import numpy as np
import pytest
from cloth_data import EPS, Cloth, motion, start
from harness import by_id, instance
from scenes import box, gravity, header


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """One for all examples."""
    return tmp_path_factory.mktemp("extremes")


SQUARE = [[0.2, 1, 0], [0, 0, 0], [1, 0, 0], [0.4, -1, 0]]  # wing, edge, edge, wing
FREE_HINGE = {"hinges": [(0, 1, 2, 3, 1)], "bond_coeffs": ["0"], "bonds": [(1, 2, 1)]}


def one_cloth(x, rest=None, **more):
    x = np.array(x, float)
    rest = x if rest is None else np.array(rest, float)
    plain = {"bonds": [(0, 1, 1)], "hinges": [], "bond_coeffs": ["1"], "hinge_coeffs": ["1"]}
    plain |= {"options": "solver gs direction current iterations 20", "dt": 0.01}
    return Cloth(x, rest + 7, 0 * x, np.ones(len(x)), **(plain | more))


@pytest.mark.parametrize("coefficient", ["1", "compliance 1e-3 compress 0.5 limit 0.1"])
def test_ends_that_coincide_stay_until_they_are_parted(folder, coefficient):
    """They have no direction to be pushed apart in."""
    cloth = one_cloth([[1, 2, 3]] * 2, [[0, 0, 0], [1, 0, 0]], bond_coeffs=[coefficient])
    x, v, _ = motion(cloth, folder)
    assert (x == [1, 2, 3]).all() and (v == 0).all()


def test_one_edge_without_rest_length_closes_to_a_point(folder):
    x, _, output = motion(one_cloth([[0, 0, 0], [1, 0, 0]], [[0, 0, 0]] * 2), folder)
    assert np.abs(x[-1, 0] - x[-1, 1]).max() < 4 * EPS
    assert output[4] < 4 * EPS  # nothing has a size: the residual is a length


def test_one_edge_is_a_cloth(folder):
    x, _, _ = motion(one_cloth([[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [2, 0, 0]]), folder)
    assert x[1, :, 0] == pytest.approx([-0.5, 1.5], abs=4 * EPS)
    assert (x[1:, :, 1:] == 0).all()


@pytest.mark.parametrize("atoms", ["bond", "angle", "full"])
def test_the_atom_style_needs_no_angles_and_no_dihedrals(folder, atoms):
    """Three vertices that are thrown up, as with atom_style molecular."""
    ends = []
    for style in ("molecular", atoms):
        with instance() as lmp:
            lmp.commands_string(
                header("f f f", style)
                + box("-2 2 -2 2 -2 2", room="bond/types 1 extra/bond/per/atom 4")
                + "mass 1 1\n"
                + "".join(f"create_atoms 1 single {x - 1} {0.25 * x * x} 0\n" for x in range(3))
                + "pair_style zero 1\npair_coeff * *\nbond_style pbd\nbond_coeff 1 1\n"
                + "".join(f"create_bonds single/bond 1 {n} {n + 1}\n" for n in (1, 2))
                + gravity()
                + "velocity all ramp vz 0 3 x -1 1 units box\ntimestep 1e-2\n"
                + "fix sheet all pbd/cloth\nrun 10\n"
            )
            ends.append(by_id(lmp, "x"))
    assert abs(ends[0][2, 2]) > 0.1
    np.testing.assert_array_equal(*ends)


@pytest.mark.parametrize("text", ["compliance 1e300", "compliance 1e10 compress 1e-310"])
def test_a_compliance_beyond_all_measure_does_nothing(folder, text):
    """Over the time step squared, and over the share in compression, it would be infinite."""
    pair = [[1, 1, 1], [2, 1, 1]], [[0, 0, 0], [2, 0, 0]]
    x, _, _ = motion(one_cloth(*pair, bond_coeffs=[text], dt=1e-6), folder)
    assert (x == x[0]).all()


HEIGHTS = {"sliver": 1e-9, "on the edge": 0.0, "denormal": 1e-310}


@pytest.mark.parametrize("height", HEIGHTS.values(), ids=HEIGHTS)
def test_a_triangle_without_a_normal_has_no_hinge(folder, height):
    wing = [[0.2, height, 0], *SQUARE[1:]]
    bent = [[0.2, 0.8, 0.5], *SQUARE[1:]]
    x, _, _ = motion(one_cloth(wing, bent, **FREE_HINGE), folder)
    assert (x == x[0]).all()


def test_a_rest_shape_without_an_angle_is_flat(folder):
    flat = motion(one_cloth([[0.2, 0.8, 0.5], *SQUARE[1:]], SQUARE, **FREE_HINGE), folder)[0]
    none = [[0.2, 0, 0], *SQUARE[1:]]
    x, _, _ = motion(one_cloth([[0.2, 0.8, 0.5], *SQUARE[1:]], none, **FREE_HINGE), folder)
    assert (x == flat).all() and (x[1] != x[0]).any()


POSES = {
    "flat": SQUARE,
    "folded": [[0.2, 1, 0], [0, 0, 0], [1, 0, 0], [0.4, 1, 0]],
    "nearly folded": [[0.2, 1, 1e-9], [0, 0, 0], [1, 0, 0], [0.4, 1, 0]],
    "inverted": [[0.2, 1, 1], [0, 0, 0], [1, 0, 0], [0.4, -1, 0]],
}


@pytest.mark.parametrize("pose", POSES)
def test_a_hinge_finds_its_angle_from_everywhere(folder, pose):
    """From flat, from both sides of folded and from the wrong side, with edges that hold."""
    rest = [[0.2, 1, -1], *SQUARE[1:]]
    edges = [(0, 1, 1), (0, 2, 1), (1, 2, 1), (1, 3, 1), (2, 3, 1)]
    cloth = one_cloth(POSES[pose], rest, **(FREE_HINGE | {"bonds": edges}), steps=100)
    cloth.bond_coeffs = ["compliance 1e-6"]
    cloth.options = "solver gs direction current iterations 200 damping 50"
    _, _, output = motion(cloth, folder)
    assert output[4] < 1e-3


def test_both_ends_pinned(folder):
    cloth = one_cloth([[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [2, 0, 0]], pins=[0, 1])
    x, _, output = motion(cloth, folder)
    assert (x == x[0]).all()
    assert output[3] == output[4] == 0  # a length that is the user's


def test_pieces_do_not_know_of_each_other(folder):
    piece = np.array([[0.2, 1, 0.7], *SQUARE[1:]])
    alone, _, _ = motion(one_cloth(piece, SQUARE, **FREE_HINGE), folder)
    cloth = one_cloth(
        [*piece, *piece, [9, 9, 9]],
        [*SQUARE, *SQUARE, [9, 9, 9]],
        bonds=[(1, 2, 1), (5, 6, 1)],
        bond_coeffs=["0"],
        hinges=[(0, 1, 2, 3, 1), (4, 5, 6, 7, 1)],
    )
    x, _, _ = motion(cloth, folder)
    assert (x[1] != x[0]).any()
    assert (x[:, :4] == alone).all() and (x[:, 4:8] == alone).all()
    assert (x[:, 8] == 9).all()  # no bond, no force: it stays


def test_a_bond_that_is_written_twice_is_one(folder):
    pair = [[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [2, 0, 0]]
    once, _, _ = motion(one_cloth(*pair, bond_coeffs=["0.5"]), folder)
    twice = one_cloth(*pair, bond_coeffs=["0.5"], bonds=[(0, 1, 1), (1, 0, 1), (0, 1, 1)])
    assert (motion(twice, folder)[0] == once).all()


COPIES = {
    "reversed": [(0, 1, 2, 3, 1), (3, 2, 1, 0, 1)],
    "wings exchanged": [(0, 1, 2, 3, 1), (3, 1, 2, 0, 1)],
    "wings exchanged, the other first": [(3, 1, 2, 0, 1), (0, 1, 2, 3, 1)],
    "all": [(3, 1, 2, 0, 1), (0, 2, 1, 3, 1), (3, 2, 1, 0, 1), (0, 1, 2, 3, 1)],
}


@pytest.mark.parametrize("copies", COPIES.values(), ids=COPIES)
@pytest.mark.parametrize("newton", ["on", "off"])
def test_a_hinge_that_is_written_twice_is_one(folder, copies, newton):
    """In any order of its vertices; its angle has the sign of one way to write it."""
    angles = "compute angles all pbd/local sheet hinge id1 id4 angle"
    ends = []
    for hinges in ([(0, 1, 2, 3, 1)], copies):
        bent = one_cloth(
            [[0.2, 0.8, 0.5], *SQUARE[1:]], SQUARE, **(FREE_HINGE | {"hinges": hinges})
        )
        bent.hinge_coeffs = ["0.5"]
        with start(bent, folder, newton) as lmp:
            lmp.commands_string(f"{angles}\nrun 3")
            ends.append((by_id(lmp, "x"), np.array(lmp.numpy.extract_compute("angles", 2, 2))))
    assert (ends[1][0] == ends[0][0]).all()
    assert ends[1][1].shape == (1, 3) and (ends[1][1] == ends[0][1]).all()


@pytest.mark.parametrize("bonds", [[(0, 1, 1), (0, 1, 2)], [(0, 1, 2), (1, 0, 1)]])
@pytest.mark.parametrize("newton", ["on", "off"])
def test_bonds_of_two_types_between_the_same_vertices_both_act(folder, bonds, newton):
    """A spring and a limit of the strain, in any order."""
    cloth = one_cloth(
        [[0, 0, 0], [2, 0, 0]],
        [[0, 0, 0], [1, 0, 0]],
        bonds=bonds,
        bond_coeffs=["compliance 1e3", "0 limit 0.5"],
        steps=1,
    )
    x, _, _ = motion(cloth, folder, newton)
    assert x[1, 1, 0] - x[1, 0, 0] == pytest.approx(1.5, rel=1e-6)


def test_three_triangles_at_one_edge_rest(folder):
    """Each pair of them is a hinge, and none wants anything at rest."""
    x = [[0.5, 1, 0], [0, 0, 0], [1, 0, 0], [0.5, -0.5, 0.9], [0.5, -0.5, -0.9]]
    hinges = [(0, 1, 2, 3, 1), (3, 1, 2, 4, 1), (4, 1, 2, 0, 1)]
    seen, _, _ = motion(one_cloth(x, bonds=[(1, 2, 1)], hinges=hinges), folder)
    assert np.abs(seen - seen[0]).max() < 100 * EPS


def no_mass(cloth, folder):
    lmp = start(cloth, folder)
    lmp.commands_string("fix mass all property/atom rmass ghost yes\nrun 0")


def lost_rest(cloth, folder, fix="again"):
    lmp = start(cloth, folder)
    lmp.command(f"write_restart {folder}/x.restart")
    lmp = instance()
    lmp.commands_string(
        f"atom_modify map yes\nread_restart {folder}/x.restart\ncomm_modify vel yes\n"
        f"fix {fix} all property/atom d2_rest 3\nfix anew all pbd/cloth rest d2_rest\nrun 0"
    )


ENDS = {
    "no mass": (no_mass, {}, r"vertex 2 has no mass: give it one with 'set group all mass'"),
    "one vertex": (start, {"bonds": [], "x": [[0, 0, 0]]}, r"group all has no bonds"),
    "rest positions not filled": (lost_rest, {}, r"'d2_rest' is 0 everywhere: .* by the fix ID"),
    "rest position of NaN": (
        start,
        {"rest": [[0, 0, 0], [0, np.nan, 0]]},
        r"vertex 2 has no rest position",
    ),
    "hinges that contradict each other": (
        motion,
        {
            "x": [*SQUARE[:3], [0.4, -1, 0.3]],
            "rest": [*SQUARE[:3], [0.4, -0.3, -0.8]],
            "hinges": [(0, 1, 2, 3, 1), (3, 1, 2, 0, 2)],
            "bond_coeffs": ["0"],
            "hinge_coeffs": ["1", "1 rest flat"],
            "options": "solver gs direction current iterations 100",
            "steps": 100,
        },
        r"flew apart in step \d+: hinges may contradict",
    ),
}


@pytest.mark.parametrize(("act", "more", "message"), ENDS.values(), ids=ENDS)
def test_ends_with_an_error_that_names_it(folder, act, more, message):
    cloth = one_cloth(**({"x": [[0, 0, 0], [1, 0, 0]]} | more))
    with pytest.raises(Exception, match=r"fix \w+ pbd/cloth: .*" + message):
        act(cloth, folder)


@pytest.mark.parametrize(
    ("more", "message"),
    [({"bonds": [(0, 0, 1)]}, "Bonds"), ({"hinges": [(0, 1, 2, 0, 1)]}, "Dihedrals")],
)
def test_a_vertex_twice_in_a_bond_or_hinge_is_refused_by_lammps(folder, more, message):
    with pytest.raises(Exception, match=f"Invalid atom ID in {message} section"):
        start(one_cloth(SQUARE, **more), folder)


def test_rest_positions_that_are_found_again_after_a_restart(folder):
    """Otherwise the error above would prove nothing."""
    lost_rest(one_cloth([[0, 0, 0], [1, 0, 0]]), folder, fix="rest")
