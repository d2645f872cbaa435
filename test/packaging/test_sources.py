# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Rules every file keeps: its length, its notice, and nothing of one machine in it."""

from pathlib import Path
import re

import pytest

pytestmark = pytest.mark.timeout(60)

LONGEST = 400
NOTICE = """\
# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""


def relative(paths, root):
    """Return paths as text, from the root."""
    return [str(path.relative_to(root)) for path in paths]


def test_no_file_of_the_package_is_too_long(root):
    lengths = {path: len(path.read_text(encoding='utf-8').splitlines())
               for path in (root / 'cam_motion').rglob('*.py')}
    assert relative([path for path, n in lengths.items() if n > LONGEST], root) == []


def test_every_source_file_carries_the_notice(files, root):
    bare = []
    for path in files:
        if path.suffix != '.py' and path.parent != root / 'scripts':
            continue
        text = path.read_text(encoding='utf-8')
        text = text.partition('\n')[2] if text.startswith('#!') else text
        if text and not text.startswith(NOTICE):
            bare.append(path)
    assert relative(bare, root) == []


def test_no_file_names_a_place_of_one_machine(files, root):
    places = [re.escape(str(place)) + r'(?![\w-])' for place in (root, Path.home())
              if len(place.parts) > 1]
    places.append(r'/(home|Users)/\w+/')
    forbidden = re.compile('|'.join(places))
    assert relative([path for path in files if forbidden.search(content(path))], root) == []


def test_no_file_names_a_package_index(files, root):
    options = '|'.join(['index' + '[-_]url', 'find' + '[-_]links', 'trusted' + '[-_]host'])
    hosts = r'https?://[^/\s]*(pypi|pythonhosted|artifactory|nexus)'
    forbidden = re.compile(f'{options}|{hosts}', re.IGNORECASE)
    assert relative([path for path in files if forbidden.search(content(path))], root) == []


def content(path):
    """Return the text of a file, whatever it holds."""
    return path.read_text(encoding='utf-8', errors='replace')


def test_the_pipeline_runs_without_help(root):
    script = root / '.ci' / 'run'
    assert script.stat().st_mode & 0o111
    assert 'make lint' in script.read_text() and 'make test' in script.read_text()
