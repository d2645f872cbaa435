# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""What README shows is what the program says."""

from pathlib import Path
import re

from cam_motion.cli import main
from cam_motion.io.reference import BLOCKS, refreshed, TABLES
import pytest

pytestmark = pytest.mark.timeout(60)

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / 'README.md').read_text(encoding='utf-8')
PARAMETERS = (ROOT / 'doc' / 'parameters.md').read_text(encoding='utf-8')


def test_the_generated_tables_are_up_to_date():
    assert refreshed(README) == README
    assert refreshed(PARAMETERS) == PARAMETERS
    assert set(re.findall(r'<!-- generated: (\w+) -->', README + PARAMETERS)) == set(BLOCKS)


def test_a_parameter_that_the_tables_lack_would_be_noticed():
    spec = TABLES['master_shaft'][0]
    assert refreshed(
        PARAMETERS.replace(f'| `{spec.name}` |', '| `forgotten` |')) == PARAMETERS


def test_every_link_and_picture_leads_to_a_file():
    links = [link for link in re.findall(r'\]\(([^)#]+)\)', README) if '://' not in link]
    assert len(links) >= 5
    assert [link for link in links if not (ROOT / link).exists()] == []


def test_no_placeholder_is_left():
    assert re.findall(r'\b[A-Z]+_OUTPUT\b|\bOUTPUT_\d+\b|\bEXAMPLE_\d+\b', README) == []


def test_the_check_shown_is_what_the_command_prints(capsys, monkeypatch):
    monkeypatch.setenv('COLUMNS', '80')
    monkeypatch.chdir(ROOT)
    assert main(['check', 'config/cutting_machine.yaml']) == 0
    printed = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    block = re.search(r'cam_motion check config/cutting_machine.yaml\n```\n\n```text\n(.*?)```',
                      README, re.DOTALL)
    shown = [line for line in block.group(1).splitlines() if line and line != '...']
    assert [line for line in shown if line not in printed] == []


@pytest.mark.parametrize('verb', ['laws', 'check', 'plot', 'line', 'record', 'report'])
def test_every_verb_of_the_readme_exists(verb, capsys):
    with pytest.raises(SystemExit) as done:
        main([verb, '--help'])
    assert done.value.code == 0
    assert f'cam_motion {verb}' in README
    assert verb in capsys.readouterr().out


def test_the_yaml_shown_is_that_of_the_machine_file():
    block = re.search(r'```yaml\n(.*?)```', README, re.DOTALL).group(1)
    machine = (ROOT / 'config' / 'cutting_machine.yaml').read_text(encoding='utf-8')
    lines = [line.split('#')[0].rstrip() for line in block.splitlines()]
    known = {line.split('#')[0].rstrip() for line in machine.splitlines()}
    assert [line for line in lines if line not in known] == []
