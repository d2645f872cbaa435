# Copyright 2026 The cam_motion authors
# Licensed under the Apache License, Version 2.0 (the "License"); you may not use this file except
# in compliance with the License. You may obtain a copy of the License at
# http://www.apache.org/licenses/LICENSE-2.0 Unless required by applicable law or agreed to in
# writing, software distributed under the License is distributed on an "AS IS" BASIS, WITHOUT
# WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied. See the License for the specific
# language governing permissions and limitations under the License.
"""Install cam_motion, the same way for colcon (ament_python) and for pip."""

from glob import glob

from setuptools import find_packages, setup

package_name = 'cam_motion'
nodes = ['master_shaft', 'cam_axis', 'drive_sim', 'linkage_state', 'bag_recorder', 'line']

setup(
    name=package_name,
    version='0.1.0',
    description='The electronic line shaft for ROS 2: timing diagrams in YAML become a '
                'synchronised packaging machine.',
    author='The cam_motion authors',
    maintainer='The cam_motion authors',
    maintainer_email='cam_motion@users.noreply.github.com',
    license='Apache-2.0',
    python_requires='>=3.10',
    packages=find_packages(include=[package_name, f'{package_name}.*']),
    package_data={package_name: ['py.typed', '**/*.html', '**/*.yaml']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{package_name}']),
        (f'share/{package_name}', ['package.xml', *glob('README.md')]),
        (f'share/{package_name}/config', sorted(glob('config/*.yaml'))),
        (f'share/{package_name}/launch', sorted(glob('launch/*'))),
        # What `ros2 run` and launch files start; each hands over to its namesake in bin/.
        (f'lib/{package_name}', sorted(glob('scripts/*'))),
    ],
    # No ROS package belongs here: package.xml names those.
    install_requires=[
        'ezdxf',
        'lz4',
        'matplotlib',
        'mcap',
        'numpy',
        'pillow',
        'PyYAML',
        'rich',
        'rosbags',
        'ruamel.yaml',
        'scipy',
        'zstandard',
    ],
    extras_require={
        'mp4': ['imageio-ffmpeg'],
        'test': ['distributed', 'hypothesis', 'pytest', 'pytest-timeout'],
    },
    entry_points={
        'console_scripts': [
            f'{package_name} = {package_name}.start:command_line',
            *(f'{node} = {package_name}.start:{node}' for node in nodes),
        ],
    },
    zip_safe=False,
)
