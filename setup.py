"""Builds the Python module with scikit-build; docs/howto/install.md states the packages that it needs."""
import pathlib
import re

import skbuild

ROOT = pathlib.Path(__file__).resolve().parent
project = re.search(r'project\(modebank VERSION (\S+) .* DESCRIPTION "(.*)"\)', (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"))

skbuild.setup(
    name="modebank",
    version=project[1],
    description=project[2],
    python_requires=">=3.11",
    install_requires=["numpy", "pandas", "h5py"],
    extras_require={"figures": ["matplotlib", "scipy"]},
    packages=["modebank"],
    package_dir={"": "python"},
    cmake_install_dir="python",
    cmake_install_target="modebank_python_install",
    cmake_args=["-DMODEBANK_PYTHON=ON", "-DMODEBANK_PYTHON_FOLDER=.", "-DMODEBANK_BUILD_PROGRAM=OFF", "-DMODEBANK_BUILD_TESTS=OFF",
                "-DMODEBANK_BUILD_BENCHMARKS=OFF", "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=40"],
)
