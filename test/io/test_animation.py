# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Films: their data against the solvers, their frames, and the files."""

from dataclasses import replace
from html.parser import HTMLParser
import json
import math
from pathlib import Path
import shutil
import subprocess
import sys
from types import SimpleNamespace

from cam_motion.errors import CamMotionError, ConfigurationError
from cam_motion.io.animation import lettering, mp4, save
from cam_motion.io.animation.axes import axes_film
from cam_motion.io.animation.cam_disc import cam_disc_film
from cam_motion.io.animation.course import angle_ticks, cycle_of, recorded_course
from cam_motion.io.animation.drawing import round_below
from cam_motion.io.animation.gif import write_gif
from cam_motion.io.animation.linkage import case_film, driven_film
from cam_motion.io.animation.pace import pace, Wishes
from cam_motion.io.animation.page import film_as_data
from cam_motion.io.animation.save import Look, output_problems, save_film
from cam_motion.io.animation.stage import Stage, usual_size
from cam_motion.io.cam_disc_config import build_cam_discs
from cam_motion.io.config import load_machine, read_sections
from cam_motion.io.linkage_config import build_linkage
from cam_motion.io.machine import build_machine
from cam_motion.io.recording import Recording, RecordingError, Track
from cam_motion.mechanism.linkage_motion import move
from cam_motion.mechanism.umbrella import Umbrella
from hypothesis import given
from hypothesis import strategies as st
import numpy as np
from PIL import Image
import pytest

pytestmark = pytest.mark.timeout(60)

CONFIG = Path(__file__).resolve().parents[2] / 'config'
UMBRELLA = build_linkage('umbrella', read_sections(CONFIG / 'umbrella.yaml')['umbrella'])
CUTTING = load_machine(CONFIG / 'cutting_machine.yaml')
SMALL = (360, 240)
SOLVER = 1e-12
WRITTEN = 5e-6  # relative: six digits are written
SHORT = Wishes(fps=8.0, seconds=1.0)


@pytest.fixture(scope='module')
def film():
    """Give eight frames of the umbrella while both inputs move."""
    return case_film(UMBRELLA, UMBRELLA.cases['both'], SHORT)


@pytest.fixture(scope='module')
def stage(film):
    """Give the same as a small picture."""
    return Stage(film, SMALL)


@pytest.fixture(scope='module')
def short(film):
    """Give the same with one panel only, which is drawn faster."""
    return replace(film, panels=film.panels[:1])


@pytest.fixture(scope='module')
def cycle():
    """Give a cycle of the cutting machine in 36 frames."""
    return cycle_of(CUTTING, Wishes(fps=36.0, seconds=1.0))


def solved(film):
    """Solve the umbrella anew at the time of each frame: motions and, in closed form, angles."""
    case = UMBRELLA.cases['both']
    for time in np.linspace(0.0, case.duration, len(film)):
        at = {name: case.inputs.values[name] + rate * time
              for name, rate in case.inputs.rates.items()}
        yield (move(UMBRELLA.assembly, UMBRELLA.assembly.at(at), case.inputs.rates),
               Umbrella().angles(at['h1'], at['h2']))


# ---- pace ---------------------------------------------------------------------------------------
@pytest.mark.parametrize('duration, cycles, seconds', [
    (7.2, 0, 7.2), (1.0, 1, 5.0), (0.3, 1, 5.0), (10.0, 12, 12.0), (300.0, 33, 15.0)])
def test_a_film_goes_in_real_time_where_one_can_follow_it(duration, cycles, seconds):
    assert pace(Wishes(), duration, cycles).count == round(25.0 * seconds)


def test_speed_and_length_say_the_same_in_two_ways():
    slow, long = (pace(wishes, 1.0, closed=True)
                  for wishes in (Wishes(speed=0.1), Wishes(seconds=10.0)))
    assert slow == long and slow.note == '10 times slower'
    assert pace(Wishes(seconds=0.4), 1.0, closed=True).note == '2.5 times as fast'
    assert pace(Wishes(seconds=1.0), 1.0).note == 'in real time'


@pytest.mark.parametrize('wishes', [
    Wishes(seconds=1.0, speed=1.0), Wishes(seconds=0.01), Wishes(seconds=1e4)])
def test_a_pace_that_makes_no_film_is_refused(wishes):
    with pytest.raises(ConfigurationError):
        pace(wishes, 1.0)


@given(st.integers(2, 700), st.booleans(), st.floats(0.01, 100.0))
def test_frames_are_evenly_spaced_among_the_points_of_the_curves(count, closed, duration):
    timing = pace(Wishes(fps=float(count), seconds=1.0), duration, closed=closed)
    frames = timing.frames(timing.times)
    assert len(frames) == count and len(timing.times) > 360
    assert timing.times[-1] == pytest.approx(duration)
    step = duration / (count if closed else count - 1)
    assert frames == pytest.approx(step * np.arange(count), abs=1e-9 * duration)


@given(st.floats(1e-6, 1e6))
def test_a_round_number_is_below_and_not_far(value):
    low = round_below(value)
    assert low <= value * (1 + 1e-9) and 2.5 * low > value * (1 - 1e-9)
    assert f'{low:.0e}'[0] in '125'


def test_ticks_of_angles_stay_few():
    assert angle_ticks(1) == [0, 45, 90, 135, 180, 225, 270, 315, 360]
    assert all(len(angle_ticks(turns)) <= 10 and angle_ticks(turns)[-1] <= 360 * turns
               for turns in range(1, 25))


# ---- linkage ------------------------------------------------------------------------------------
def test_joints_and_arrows_are_drawn_where_the_solver_and_the_closed_forms_put_them(film, stage):
    names = [point.name for point in UMBRELLA.linkage.points]
    joints, = (artist for shape, artist in stage.shapes if shape.joints)
    (arrows, quiver), = stage.arrows
    for frame, (motion, angles) in enumerate(solved(film)):
        stage.pose(frame)
        drawn = dict(zip(names, joints.get_xdata() + 1j * joints.get_ydata()))
        assert drawn == pytest.approx({name: motion.points[name].position for name in names},
                                      abs=SOLVER)
        h1 = motion.position['h1']
        assert drawn['A'] == 0.0 and drawn['B'] == pytest.approx(-1j * h1, abs=SOLVER)
        assert drawn['C'] == pytest.approx(np.exp(1j * angles[0]), abs=SOLVER)
        assert drawn['G'] == pytest.approx(-1j * h1 + 2.6 * np.exp(1j * angles[1]),
                                           abs=SOLVER)
        velocities = np.array([motion.points[name].velocity for name in arrows.names])
        assert quiver.U + 1j * quiver.V == pytest.approx(arrows.scale * velocities, abs=SOLVER)
        assert quiver.get_offsets() @ [1, 1j] == pytest.approx(
            [drawn[name] for name in arrows.names], abs=SOLVER)


def test_velocities_are_the_slopes_of_the_ways():
    film = case_film(UMBRELLA, UMBRELLA.cases['both'], Wishes(fps=50.0, seconds=7.2))
    arrows, = film.drawing.arrows
    middle = (arrows.feet[2:] - arrows.feet[:-2]) / (2.0 * 7.2 / (len(film) - 1))
    early = slice(None, 300)  # towards the end the linkage comes near to a singular position
    assert arrows.vectors[1:-1][early] == pytest.approx(middle[early], abs=2e-4)


def test_the_curves_are_those_of_the_solver_and_the_cursor_is_on_them(film, stage):
    angle, omega, speed, length = film.panels
    assert [curve.name for curve in angle.curves] == ['theta2', 'theta3', 'theta5', 'theta6']
    assert [curve.name for curve in omega.curves] == ['omega2', 'omega3', 'omega5', 'omega6']
    assert [curve.name for curve in speed.curves] == ['B', 'C', 'G', 'F', 'E', 'D']
    assert [curve.name for curve in length.curves] == ['h1', 'h2']
    for frame, (motion, angles) in enumerate(solved(film)):
        assert [curve.at[frame] for curve in angle.curves] == pytest.approx(
            np.degrees(angles), abs=1e-10)
        assert [curve.at[frame] for curve in omega.curves] == pytest.approx(
            [motion.velocity[f'theta{k}'] for k in (2, 3, 5, 6)], abs=SOLVER)
        assert [curve.at[frame] for curve in speed.curves] == pytest.approx(
            [abs(motion.points[name].velocity) for name in 'BCGFED'], abs=SOLVER)
        stage.pose(frame)
        for panel in film.panels:
            for curve in panel.curves:
                assert curve.at[frame] == pytest.approx(
                    np.interp(film.cursor[frame], curve.x, curve.y), abs=1e-12)
        assert all(list(line.get_xdata()) == [film.cursor[frame]] * 2 for line in stage.cursors)
        assert [dot.get_ydata()[0] for _, dot in stage.dots] == [
            curve.at[frame] for curve, _ in stage.dots]


def test_scales_stay_and_hold_everything_in_every_frame(film, stage):
    limits = [(axes.get_xlim(), axes.get_ylim()) for axes in (stage.drawing, *stage.panels)]
    (left, right), (bottom, top) = limits[0]
    for frame in range(len(film)):
        stage.frame(frame)
        arrows, = film.drawing.arrows
        everything = np.concatenate([
            *(shape.at(frame) for shape in film.drawing.shapes),
            arrows.feet[frame] + arrows.scale * arrows.vectors[frame]])
        assert left < everything.real.min() and everything.real.max() < right
        assert bottom < everything.imag.min() and everything.imag.max() < top
    assert limits == [(axes.get_xlim(), axes.get_ylim())
                      for axes in (stage.drawing, *stage.panels)]
    for panel, axes in zip(film.panels, stage.panels):
        low, high = axes.get_ylim()
        assert all(low < curve.y.min() and curve.y.max() < high for curve in panel.curves)


def test_the_drawing_has_one_scale_both_ways(stage):
    origin, right, up = stage.drawing.transData.transform([(0, 0), (1, 0), (0, 1)])
    assert right[0] - origin[0] == pytest.approx(up[1] - origin[1], rel=1e-9)


def test_a_line_drives_its_linkage():
    machine = load_machine(CONFIG / 'umbrella.yaml')
    course = cycle_of(machine, SHORT)
    settings = machine.linkages['umbrella']
    film = driven_film(settings, course)
    slider = machine.diagram.axes['slider'].layout.motion
    h1, h2 = film.panels[-1].curves
    assert (film.across, len(film)) == ('shaft angle φ [deg]', 8)
    assert h1.y == pytest.approx(slider(np.radians(h1.x))[0], abs=SOLVER)
    points = [point.name for point in settings.linkage.points]
    joints = film.drawing.shapes[-1].points
    assert joints[:, points.index('B')] == pytest.approx(-1j * h1.at, abs=SOLVER)
    # B is the slider: its arrow is the speed of the axis
    arrows, = film.drawing.arrows
    speed = slider(np.radians(film.cursor))[1] * machine.master.speed
    assert arrows.vectors[:, list(arrows.names).index('B')] == pytest.approx(-1j * speed)


def test_turns_that_a_crank_had_made_before_the_run_are_not_gone_through():
    machine = load_machine(CONFIG / 'slider_crank.yaml')
    settings = machine.linkages['slider_crank']
    course = cycle_of(machine, SHORT)
    before = [[86400 * math.tau], [0.0], [0.0]]
    later = replace(course, axes={'motor': course.axes['motor'] + before})
    ways = [driven_film(settings, each).drawing.arrows[0].feet for each in (course, later)]
    assert np.abs(ways[1] - ways[0]).max() < 1e-9


# ---- axes ---------------------------------------------------------------------------------------
def test_axes_are_shown_where_their_cams_are(cycle):
    film = axes_film(CUTTING, cycle)
    assert [panel.label for panel in film.panels] == ['feeder [m]', 'press [m]', 'knife [m]']
    phi = np.radians(film.cursor)
    assert film.cursor == pytest.approx(10.0 * np.arange(36))
    sliders = [shape for shape in film.drawing.shapes if shape.joints]
    for panel, slider, axis in zip(film.panels, sliders, CUTTING.diagram.axes.values()):
        assert panel.curves[0].at == pytest.approx(axis.profile(phi), abs=SOLVER)
        positions = axis.profile(phi)
        share = (slider.points[:, 0].real + 1.25) / 2.5
        assert share == pytest.approx(positions / positions.max(), abs=1e-6)


def test_shaded_are_the_segments_that_move(cycle):
    film = axes_film(CUTTING, cycle)
    assert [panel.spans for panel in film.panels] == [
        [pytest.approx(span) for span in spans] for spans in (
            [(0.0, 80.0)], [(90.0, 135.0), (305.0, 350.0)], [(145.0, 225.0), (235.0, 295.0)])]


def test_the_pointer_of_the_dial_turns_clockwise_from_the_top(cycle):
    pointer = next(shape for shape in axes_film(CUTTING, cycle).drawing.shapes
                   if shape.turn is not None)
    tips = [pointer.at(frame)[1] for frame in (0, 9, 18, 27)]
    assert tips == pytest.approx([1.04j, 1.04, -1.04j, -1.04], abs=1e-12)


def test_an_axis_alone_comes_with_velocity_and_acceleration(cycle):
    film = axes_film(CUTTING, cycle, 'feeder')
    assert [panel.label for panel in film.panels] == [
        'position [m]', 'velocity [m/s]', 'acceleration [m/s²]']
    peaks = [np.abs(panel.curves[0].y).max() for panel in film.panels]
    assert peaks == pytest.approx([0.3, 9.0, 329.9], rel=1e-3)  # document 001 at 200 cycles/min


def test_a_shaft_that_stands_makes_no_film():
    sections = read_sections(CONFIG / 'cutting_machine.yaml')
    sections = {**sections, 'master_shaft': {**sections['master_shaft'], 'speed_cpm': 0.0}}
    with pytest.raises(ConfigurationError, match='--speed-cpm'):
        cycle_of(build_machine(sections), SHORT)


# ---- disc cams ----------------------------------------------------------------------------------
@pytest.mark.parametrize('name', ['press_cam', 'valve_cam', 'gripper_cam', 'tucker_cam',
                                  'feeder_cam'])
def test_the_disc_touches_its_follower_in_every_frame(name):
    sections = read_sections(CONFIG / 'cam_disc.yaml')
    settings = build_cam_discs(sections)[0][name]
    film = cam_disc_film(settings, cycle_of(build_machine(sections), SHORT))
    disc, phi = settings.disc, np.radians(film.cursor)
    contour = next(shape for shape in film.drawing.shapes
                   if shape.fill and len(shape.points) > 500
                   and np.allclose(shape.points[0], disc.contour(0.0)))
    arrows, = film.drawing.arrows
    for frame in range(len(film)):
        contact = arrows.feet[frame, 0]
        away = np.abs(contour.at(frame) - contact)
        assert away.min() < 3e-3 * disc.base_radius  # half a side of the polygon
        if disc.follower.roller_radius:
            roller = next(shape for shape in film.drawing.shapes if shape.shift is not None
                          and np.ptp(shape.shift.imag + shape.shift.real) > 0.0)
            centre = roller.shift[frame]
            assert abs(contact - centre) == pytest.approx(disc.follower.roller_radius)
            assert arrows.vectors[frame, 0] == pytest.approx(
                (centre - contact) / disc.follower.roller_radius)
    pressure = film.panels[3].curves[0]
    assert pressure.at == pytest.approx(np.degrees(disc.pressure_angle(phi)))


def test_the_pressure_angle_of_document_004():
    sections = read_sections(CONFIG / 'cam_press_drive.yaml')
    settings, = build_cam_discs(sections)[0].values()
    machine = build_machine(sections)
    film = cam_disc_film(settings, cycle_of(machine, SHORT))
    travel, pressure = film.panels[0].curves[0], film.panels[3].curves[0]
    profile = machine.diagram.axes['follower'].profile
    phi = np.radians(film.cursor)
    assert travel.at == pytest.approx(profile(phi), abs=SOLVER)
    assert np.tan(np.radians(pressure.at)) == pytest.approx(
        profile(phi, 1) / (0.052 + profile(phi)), abs=1e-12)
    assert pressure.y.max() == pytest.approx(25.2536, abs=2e-3)  # the grid of the document


# ---- recorded runs ------------------------------------------------------------------------------
def track(time_ns, values):
    """Make a track, received half a millisecond late."""
    return Track(np.zeros(len(time_ns), np.int64), time_ns, *values, time_ns + 500_000)


@pytest.fixture
def recording():
    """Give one second of the cutting machine at 200 cycles/min, recorded with 500 Hz."""
    time_ns = np.arange(500, dtype=np.int64) * 2_000_000 + 7_000_000_000
    omega = CUTTING.master.speed
    phi = omega * (time_ns - time_ns[0]) * 1e-9
    still = np.zeros_like(phi)
    setpoints = {name: track(time_ns, [axis.profile(phi, k) * omega ** k for k in range(3)])
                 for name, axis in CUTTING.diagram.axes.items()}
    return Recording(Path('run'), False, CUTTING, track(time_ns, [phi, still + omega, still]),
                     setpoints, {}, {}, {}, {})


def test_a_recorded_run_shows_recorded_setpoints_only(recording):
    course = recorded_course(recording, SHORT)
    film = axes_film(CUTTING, course)
    assert film.across == 'time [s]' and film.title.endswith('recorded in run')
    for name, panel in zip(CUTTING.diagram.axes, film.panels):
        assert set(panel.curves[0].y) <= set(recording.setpoints[name].position)
    assert course.times[-1] == pytest.approx(0.998)
    phi = course.timing.frames(course.phi)
    assert film.panels[2].curves[0].at == pytest.approx(
        CUTTING.diagram.axes['knife'].profile(phi), abs=SOLVER)
    assert film.captions[-1].startswith('t = 1.00 s   φ = 118°   cycle 3')


def test_a_part_of_a_run_can_be_chosen(recording):
    course = recorded_course(recording, SHORT, (0.3, 0.6))
    assert (course.times[0], course.times[-1]) == pytest.approx((0.3, 0.6))
    assert course.phi[[0, -1]] == pytest.approx(CUTTING.master.speed * np.array([0.3, 0.6]))
    with pytest.raises(ConfigurationError, match='0 to 0.998 s'):
        recorded_course(recording, SHORT, (2.0, None))


def test_axes_that_were_not_recorded_are_left_out(recording):
    recording.setpoints['press'] = None
    film = axes_film(CUTTING, recorded_course(recording, SHORT))
    assert [panel.label for panel in film.panels] == ['feeder [m]', 'knife [m]']


def test_of_several_runs_the_longest_is_shown(recording):
    recording.shaft.run[:100] = -1
    course = recorded_course(recording, SHORT)
    assert course.times[-1] == pytest.approx(0.798)
    recording.shaft.run[:] = np.arange(500)
    with pytest.raises(RecordingError, match='single tick'):
        recorded_course(recording, SHORT)


# ---- frames -------------------------------------------------------------------------------------
def test_a_frame_has_the_size_asked_for_and_depends_on_its_number_alone(film, stage):
    first, other = stage.frame(0), stage.frame(5)
    assert first.shape == (SMALL[1], SMALL[0], 3) and first.dtype == np.uint8
    assert (first != other).any()
    assert np.array_equal(stage.frame(0), first)
    assert np.array_equal(Stage(film, SMALL).frame(5), other)
    assert usual_size(film) == (900, 560)


def test_what_stands_is_the_same_in_every_frame(film, stage):
    frames = np.array([stage.frame(k) for k in range(len(film))])
    assert (np.ptp(frames, axis=0).max(axis=-1) > 0).mean() < 0.5
    corner = frames[:, -40:, :20]  # of the margin
    assert (corner == 255).all()


def test_texts_are_stamped_where_asked_and_cut_off_at_the_edge():
    picture = np.full((40, 120, 3), 255, np.uint8)
    lettering.stamp(picture, '−12.3', (60.0, 20.0), 9.0, 100.0, 'right')
    ink = np.argwhere(picture.min(axis=-1) < 128)
    assert ink[:, 1].max() <= 61 and ink[:, 1].min() > 10
    assert abs(ink[:, 0].mean() - 20.0) < 2.0
    for place in ((-10.0, 20.0), (118.0, 39.0), (60.0, 500.0)):
        lettering.stamp(picture, 'edge', place, 9.0, 100.0)
    red = np.full((40, 120, 3), 255, np.uint8)
    lettering.stamp(red, 'X', (60.0, 20.0), 12.0, 100.0, 'center', '#FF0000')
    assert (red[:, :, 0] == 255).all() and (red[:, :, 1] < 50).any()


# ---- files --------------------------------------------------------------------------------------
def test_a_gif_reads_back(short, tmp_path):
    fps = 30.0  # which hundredths of a second do not divide
    film = replace(short, fps=fps)
    path = save_film(film, tmp_path / 'made' / 'film.gif', Look(SMALL))
    with Image.open(path) as gif:
        assert (gif.size, gif.n_frames, gif.info['loop']) == (SMALL, len(film), 0)
        lengths, pictures = [], []
        for frame in range(gif.n_frames):
            gif.seek(frame)
            lengths.append(gif.info['duration'])
            pictures.append(np.asarray(gif.convert('RGB')).astype(int))
    assert sum(lengths) == pytest.approx(1000.0 * len(film) / fps, abs=5.0)
    assert all((one != next_).any() for one, next_ in zip(pictures, pictures[1:]))
    assert (pictures[0][-8:, -8:] == 255).all()  # white stays white
    drawn = Stage(film, SMALL).frame(len(film) - 1)
    assert np.abs(pictures[-1] - drawn).mean() < 1.0
    assert list(path.parent.iterdir()) == [path]


def test_what_stands_still_costs_a_gif_nothing_however_many_colours_there_are(tmp_path):
    still = np.random.default_rng(1).integers(0, 256, (60, 80, 3), dtype=np.uint8)

    def frame(k):  # all stands still but two opposite corners
        picture = still.copy()
        picture[0, k] = picture[-1, -1 - k] = 0
        return picture

    sizes = []
    for count in (2, 12):
        film = type('Film', (), {'fps': 25.0, '__len__': lambda _, count=count: count})()
        stage = SimpleNamespace(film=film, frame=frame)
        write_gif(stage, range(count), tmp_path / 'still.gif')
        sizes.append((tmp_path / 'still.gif').stat().st_size)
    # a further frame is little more than its palette of 768 bytes, not its 4800 pixels
    assert (sizes[1] - sizes[0]) / 10 < 1200


def test_an_mp4_decodes(short, tmp_path):
    ffmpeg = pytest.importorskip('imageio_ffmpeg')
    path = save_film(short, tmp_path / 'film.mp4', Look((321, 241)))
    assert ffmpeg.count_frames_and_secs(str(path)) == (len(short), pytest.approx(1.0))
    reader = ffmpeg.read_frames(str(path))
    assert next(reader)['size'] == (322, 242)
    first = np.frombuffer(next(reader), np.uint8).reshape(242, 322, 3)[:241, :321].astype(int)
    reader.close()
    assert np.abs(first - Stage(short, (321, 241)).frame(0)).mean() < 4.0


class Page(HTMLParser):
    """What a page holds: its scripts, and whatever it would load."""

    def __init__(self, text):
        """Read a page."""
        super().__init__()
        self.scripts, self.loads, self.inside = [], [], False
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        """Note scripts and links."""
        self.inside = tag == 'script'
        self.loads += [value for name, value in attrs if name in ('src', 'href', 'action')]

    def handle_endtag(self, tag):
        """Note where a script ends."""
        self.inside = False

    def handle_data(self, data):
        """Keep what is in scripts."""
        if self.inside:
            self.scripts.append(data)


def test_a_page_holds_the_data_of_the_solver_and_loads_nothing(film, tmp_path):
    path = save_film(film, tmp_path / 'film.html')
    text = path.read_text(encoding='utf-8')
    page = Page(text)
    data = json.loads(page.scripts[0])
    assert page.loads == [] and 'url(' not in text and 'import' not in page.scripts[1]
    assert text.count('http') == 1 and 'http://www.w3.org/2000/svg' in text  # a name, no address
    assert len(text) < 120_000
    assert data == json.loads(json.dumps(film_as_data(film)))
    joints = next(shape for shape in data['shapes'] if shape['joints'])
    for frame, (motion, angles) in enumerate(solved(film)):
        places = np.array(joints['frames'][frame]).reshape(-1, 2) @ [1, 1j]
        assert places == pytest.approx([each.position for each in motion.points.values()],
                                       abs=WRITTEN * 3.0)
        vectors = np.array(data['arrows'][0]['vectors'][frame]).reshape(-1, 2) @ [1, 1j]
        assert vectors == pytest.approx([motion.points[name].velocity
                                         for name in data['arrows'][0]['names']], abs=WRITTEN)
        assert [curve['at'][frame] for curve in data['panels'][0]['curves']] == pytest.approx(
            np.degrees(angles), abs=WRITTEN * 180.0)


def test_names_cannot_break_out_of_a_page(film, tmp_path):
    evil = replace(film, title='</script><b>&"')
    page = Page(save_film(evil, tmp_path / 'film.html').read_text(encoding='utf-8'))
    assert json.loads(page.scripts[0])['title'] == evil.title


# A page without a browser: every element takes everything, and the script must run through.
STUB = """
const fs = require('fs'), text = fs.readFileSync(process.argv[1], 'utf8');
const scripts = [...text.matchAll(/<script[^>]*>([^]*?)<\\/script>/g)].map(found => found[1]);
const made = [];
const element = id => ({id, attributes: {}, setAttribute(name, value) {
  if (/NaN|undefined|Infinity/.test(value)) throw new Error(`${name}=${value}`);
  this.attributes[name] = value; }, appendChild(child) { made.push(child); return child; }});
const known = {film: {textContent: scripts[0]}};
global.document = {getElementById: id => known[id] || (known[id] = element(id)),
  createElementNS: (space, kind) => Object.assign(element(''), {kind}), addEventListener() {}};
global.location = {hash: process.argv[2]};
let tick;
global.requestAnimationFrame = step => { tick = step; };
known.speed = Object.assign(element('speed'), {value: '0.5'});
eval(scripts[1]);
tick(2000);
tick(3000);  // a second later
const dots = made.filter(each => each.kind === 'circle').map(each => each.attributes);
console.log(JSON.stringify({caption: known.caption.textContent, count: made.length, dots}));
"""


@pytest.mark.skipif(shutil.which('node') is None, reason='needs node to run the page')
def test_the_script_of_a_page_draws_the_joints_to_scale(film, tmp_path):
    path = save_film(film, tmp_path / 'film.html')

    def drawn(frame):
        done = subprocess.run(['node', '-e', STUB, str(path), f'#frame={frame}'],
                              capture_output=True, text=True, timeout=20, check=False)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)
    for frame in (0, 5):
        page = drawn(frame)
        assert page['caption'] == film.captions[frame]
        joints = next(shape for shape in film.drawing.shapes if shape.joints).at(frame)
        places = np.array([float(dot['cx']) - 1j * float(dot['cy'])
                           for dot in page['dots'][:len(joints)]])
        scale = (places[1] - places[0]) / (joints[1] - joints[0])
        assert abs(scale.imag) < 1e-6 and scale.real > 50.0
        assert places - places[0] == pytest.approx(scale.real * (joints - joints[0]), abs=2e-3)
    # 8 frames per second at half the speed
    assert drawn('none')['caption'] == film.captions[4]


@pytest.mark.parametrize('suffix', ['.gif', '.mp4'])
def test_what_is_interrupted_leaves_the_file_of_before(short, tmp_path, suffix):
    if suffix == '.mp4':
        pytest.importorskip('imageio_ffmpeg')
    path = tmp_path / f'film{suffix}'
    path.write_text('before')

    def track(frames):
        yield from frames[:3]
        raise KeyboardInterrupt
    with pytest.raises(KeyboardInterrupt):
        save_film(short, path, Look(SMALL), track)
    assert [each.name for each in tmp_path.iterdir()] == [path.name]
    assert path.read_text() == 'before'


def test_without_ffmpeg_the_ways_out_are_named(monkeypatch):
    monkeypatch.setattr(mp4.shutil, 'which', lambda name: None)
    monkeypatch.setitem(sys.modules, 'imageio_ffmpeg', None)
    problem, = output_problems(Path('film.mp4'), 25.0, Look())
    assert 'cam_motion[mp4]' in problem.hint and '.gif or .html' in problem.hint
    assert output_problems(Path('film.gif'), 25.0, Look()) == []


def test_an_ffmpeg_that_fails_is_quoted(short, tmp_path, monkeypatch):
    broken = tmp_path / 'ffmpeg'
    broken.write_text('#!/bin/sh\necho no such codec >&2\nexit 3\n')
    broken.chmod(0o755)
    monkeypatch.setattr(mp4.shutil, 'which', lambda name: str(broken))
    with pytest.raises(CamMotionError, match='no such codec'):
        save_film(short, tmp_path / 'out' / 'film.mp4', Look(SMALL))
    assert list((tmp_path / 'out').iterdir()) == []


def test_a_gif_that_would_fill_the_memory_is_refused(short, tmp_path, monkeypatch):
    monkeypatch.setattr(save, '_MOST_BYTES', 7.0 * SMALL[0] * SMALL[1])
    with pytest.raises(ConfigurationError, match='8 frames of 360x240 px.*most are 7'):
        save_film(short, tmp_path / 'film.gif', Look(SMALL))
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_said(film, tmp_path):
    (tmp_path / 'file').write_text('')
    with pytest.raises(CamMotionError, match='cannot be written'):
        save_film(film, tmp_path / 'file' / 'film.html')


def test_values_have_the_same_decimals_in_every_frame_and_no_minus_before_a_zero(film):
    panel = film.panels[0]
    assert panel.text(-12.345) == '−12.3' and panel.text(-0.01) == '0.0'
    assert math.isclose(float(film.panels[2].text(0.2)), 0.2)
