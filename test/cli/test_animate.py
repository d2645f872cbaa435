# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""The verb ``animate``: what it films, what it says, and what is refused."""

from pathlib import Path
import signal
import struct
import subprocess
import sys
import time

from cam_motion.io.bag import BagWriter
from cam_motion.io.config import load_machine
from PIL import Image
import pytest

pytestmark = pytest.mark.timeout(60)

ROOT = Path(__file__).resolve().parents[2]
CONFIG = ROOT / 'config'
UMBRELLA, CUTTING = CONFIG / 'umbrella.yaml', CONFIG / 'cutting_machine.yaml'
POINT = 'trajectory_msgs/msg/JointTrajectoryPoint'
SHORT = ('--seconds', '1', '--fps', '4')


@pytest.fixture
def animate(cam_motion, read_json, tmp_path):
    """Give a function that films into a page, and returns what it prints as JSON."""
    def run(source, *options, file='film.html'):
        done = cam_motion('animate', source, '-o', tmp_path / file, '--json', *SHORT, *options)
        assert done.returncode == 0, done.stderr
        return read_json(done.stdout)
    return run


@pytest.mark.parametrize('config, options, title', [
    ('umbrella', ('--case', 'both'), 'umbrella: both'),
    ('umbrella', ('--diagram', '--speed-cpm', '2'), 'master_shaft: one cycle at 2 cycles/min'),
    ('umbrella', ('--axis', 'slider'), 'slider: one cycle at 2.5 cycles/min'),
    ('four_bar', ('--linkage', 'four_bar', '--case', 'turn'), 'four_bar: turn'),
    ('slider_crank', ('--case', 'turn'), 'slider_crank: turn'),
    ('cutting_machine', ('--axis', 'knife'), 'knife: one cycle at 200 cycles/min'),
    ('cam_press_drive', ('--diagram',), 'press_drive: one cycle at 400 cycles/min'),
    ('cam_disc', ('--disc', 'gripper_cam'), 'gripper_cam: one cycle at 400 cycles/min'),
    ('cam_disc', ('--axis', 'tucker'), 'tucker_cam: one cycle at 400 cycles/min'),
])
def test_every_machine_has_its_film(animate, config, options, title):
    said = animate(CONFIG / f'{config}.yaml', *options)
    assert (said['title'], said['frames'], said['seconds']) == (title, 4, 1.0)
    assert Path(said['files'][0]).read_text(encoding='utf-8').startswith('<!DOCTYPE html>')


@pytest.mark.parametrize('config', sorted(CONFIG.glob('*.yaml')), ids=lambda path: path.stem)
def test_every_machine_file_can_be_filmed(animate, config):
    said = animate(config)
    shown = {'umbrella': 'umbrella', 'four_bar': 'four_bar', 'slider_crank': 'slider_crank',
             'cam_press_drive': 'press_drive', 'cam_disc': 'press_cam'}
    assert said['title'].startswith(shown.get(config.stem, 'master_shaft') + ': one cycle at ')


def test_people_are_told_what_was_filmed(cam_motion, tmp_path):
    file = tmp_path / 'umbrella.gif'
    done = cam_motion('animate', UMBRELLA, '--case', 'opening', '-o', file, *SHORT,
                      '--size', '300x200')
    assert done.returncode == 0
    assert 'umbrella: opening: 4 frames, 1 s, 7.2 times as fast' in done.stdout
    assert f'wrote {file}' in done.stdout
    with Image.open(file) as gif:
        assert (gif.size, gif.n_frames) == ((300, 200), 4)


@pytest.mark.parametrize('options, words', [
    (('-o', 'film.avi'), ['--output', '.gif, .mp4 or .html']),
    (('-o', 'film.gif', '--fps', '60'), ['--fps', 'at most 50']),
    (('-o', 'film.gif', '--fps', 'nan'), ['must be a finite number']),
    (('-o', 'film.html', '--size', '300x300', '--dpi', '50'), ['2 problems', '--size', '--dpi']),
    (('-o', 'film.gif', '--size', '10x9000', '--dpi', '5', '--seconds', '1', '--speed', '2',
      '--fps', '0'), ['5 problems', '--size', '--dpi', '--speed', '--fps']),
    (('-o', 'film.gif', '--size', 'large'), ['WIDTHxHEIGHT']),
    (('-o', 'film.gif', '--case', 'none'), ['--case', 'sliding, opening, both']),
    (('-o', 'film.gif', '--axis', 'none', '--linkage', 'no'),
     ['3 problems', 'slider, crank', 'known are: umbrella', 'one thing']),
    (('-o', 'film.gif', '--disc', 'none'), ['--disc', 'there is none']),
    (('-o', 'film.gif', '--case', 'both', '--speed-cpm', '1'), ['--speed-cpm', 'no shaft']),
    (('-o', 'film.gif', '--from', '1', '--to', '2'), ['2 problems', 'is for bags']),
    ((), ['required: -o']),
])
def test_what_makes_no_film_exits_with_2(cam_motion, options, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = cam_motion('animate', UMBRELLA, *options)
    assert (done.returncode, done.stdout) == (2, '')
    assert [word for word in words if word not in done.stderr] == []
    assert list(tmp_path.iterdir()) == []


def point(values, time_ns):
    """Serialise a JointTrajectoryPoint of one joint (CDR, little endian)."""
    return struct.pack('<4B I4xd I4xd I4xd I iI', 0, 1, 0, 0, 1, values[0], 1, values[1], 1,
                       values[2], 0, *divmod(time_ns, 10 ** 9))


@pytest.fixture
def bag(tmp_path):
    """Give a function that records two seconds of a machine at its set speed, at 100 Hz."""
    def write(config, axes=None):
        machine = load_machine(config)
        omega = machine.master.speed
        names = list(machine.diagram.axes) if axes is None else axes
        with BagWriter(tmp_path / 'bag', custom_data={'machine': config.read_text()}) as writer:
            shaft = writer.add_topic('/shaft', POINT)
            topics = {name: writer.add_topic(f'/{name}/setpoint', POINT) for name in names}
            for tick in range(200):
                now, phi = tick * 10_000_000, tick * 0.01 * omega
                writer.write(shaft, now + 10 ** 18, point((phi, omega, 0.0), now))
                for name, topic in topics.items():
                    y, slope, bend, _ = machine.diagram.axes[name].layout.motion.sample(phi)
                    setpoint = (y, slope * omega, bend * omega ** 2)
                    writer.write(topic, now + 10 ** 18, point(setpoint, now))
        return tmp_path / 'bag'
    return write


@pytest.mark.parametrize('config, options, title', [
    (UMBRELLA, ('--to', '1'), 'umbrella: recorded in bag'),
    (CUTTING, (), 'master_shaft: recorded in bag'),
    (CUTTING, ('--axis', 'knife', '--from', '0.5'), 'knife: recorded in bag'),
    (CONFIG / 'cam_disc.yaml', ('--disc', 'valve_cam'), 'valve_cam: recorded in bag'),
])
def test_a_bag_is_filmed_by_the_machine_file_that_it_carries(animate, bag, config, options, title):
    assert animate(bag(config), *options)['title'] == title


def test_a_bag_without_what_drives_its_linkage_is_refused(cam_motion, bag, tmp_path):
    done = cam_motion('animate', bag(UMBRELLA, ['slider']), '-o', tmp_path / 'film.html')
    assert done.returncode == 2 and 'umbrella.h2.axis' in done.stderr
    done = cam_motion('animate', tmp_path / 'bag', '-o', tmp_path / 'film.html', '--case', 'both')
    assert done.returncode == 2 and '--case' in done.stderr


def test_ctrl_c_ends_it_and_leaves_no_half_film(tmp_path):
    process = subprocess.Popen(
        [sys.executable, '-m', 'cam_motion', 'animate', str(UMBRELLA), '-o',
         str(tmp_path / 'film.gif'), '--seconds', '60'],
        cwd=tmp_path, env={'PYTHONPATH': str(ROOT)}, stderr=subprocess.PIPE, text=True)
    try:
        until = time.monotonic() + 40.0
        while (not list(tmp_path.rglob('film.gif')) and process.poll() is None
               and time.monotonic() < until):
            time.sleep(0.05)
        assert process.poll() is None
        process.send_signal(signal.SIGINT)
        assert process.wait(20.0) == 1
        assert process.stderr.read() == 'cam_motion: interrupted\n'
    finally:
        process.kill()
        process.communicate()
    assert list(tmp_path.iterdir()) == []
