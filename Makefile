# make demo and make test are all a new machine needs; see README.md.
# A compiler for each processor, but only one for every 2.5 GB of free memory: the largest sources take 2.3 GB.
JOBS := $(shell awk -v cores=$$(nproc) '/^MemAvailable/ { most = int($$2 / 2500000); print most < 1 ? 1 : most < cores ? most : cores }' /proc/meminfo)
DEMO := build/demo

.PHONY: all api build demo packages package-test dist dist-test pip-test test bench-programs bench benchmarks guards uncertainty recovery evidence gyro-lost rule systems quantised scale cost features track-day export-recovery check format lint shellcheck tidy tidy-changed strict seeds sanitize coverage arm64 picture clean fuzz faults docs docs-examples docs-update reference-ini slurm shared-fs page-drag pages-large firefox

all: build

# Configured for the program alone; `make test` and `make bench` add to the same folder what they need.
PROGRAM_ALONE := $(if $(wildcard build/CMakeCache.txt),,-DMODEBANK_BUILD_TESTS=OFF -DMODEBANK_BUILD_BENCHMARKS=OFF)
build/build.ninja: CMakePresets.json | packages-build
	cmake --preset release $(PROGRAM_ALONE) >/dev/null

build: packages-build build/build.ninja
	cmake --build --preset release -j $(JOBS) --target modebank

packages-build:
	@sh .ci/install-packages build page

packages-%:
	@sh .ci/install-packages $*

# The program for development, build/dev/modebank: each source on its own, so that one edited line is compiled and linked in seconds.
build/dev/build.ninja: CMakePresets.json
	@$(MAKE) --no-print-directory packages-build
	cmake --preset dev >/dev/null
	@touch $@

.PHONY: dev
dev: build/dev/build.ninja
	cmake --build --preset dev -j $(JOBS) --target modebank

# Simulates a robot on ice and grip with known truth and takes the whole chain over its runs.
demo: build
	@rm -rf $(DEMO)
	build/modebank demo -o $(DEMO)

# Debian packages, build/packages/*.deb, and a trial in an empty Debian 12, which takes minutes.
packages: packages-build packages-package build/build.ninja
	cmake --preset release -DMODEBANK_PYTHON=ON >/dev/null
	rm -rf build/packages
	cmake --build --preset release -j $(JOBS) --target modebank_packages

package-test: packages packages-root
	packaging/test_packages.sh build/packages build/empty_root

# The program with its libraries for any Linux that has their glibc, and a trial in empty Debian 12 and 13.
dist: packages-build packages-dist build/build.ninja
	cmake --preset release >/dev/null
	cmake --build --preset release -j $(JOBS) --target modebank_dist

dist-test: dist packages-root
	packaging/test_dist.sh build/modebank-*.tar.gz build/empty_root

# Installs the Python module by pip in an empty Debian 12.
pip-test: packages-root
	packaging/test_pip.sh build/empty_root

test: packages-build packages-test build/build.ninja
	cmake --preset release -DMODEBANK_BUILD_TESTS=ON -DMODEBANK_PYTHON=ON >/dev/null
	cmake --build --preset release -j $(JOBS)
	@status=0; ctest --preset release -j $(JOBS) --output-junit $(CURDIR)/build/tests.xml || status=$$?; \
	/usr/bin/python3 tests/skipped.py build/tests.xml; exit $$status

bench-programs: packages-build packages-bench build/build.ninja
	cmake --preset release -DMODEBANK_BUILD_BENCHMARKS=ON >/dev/null
	cmake --build --preset release -j $(JOBS) --target modebank benchmarks

# The others compare window fits and EM with other people's, in Python too where it is installed.
bench: bench-programs
	build/bench_modebank
	build/compare_windows 5 build/compare_windows.bin
	build/compare_imm
	build/track_latency build/modebank
	-OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 /usr/bin/python3 tests/bench/window_peers.py build/compare_windows.bin
	OMP_NUM_THREADS=1 build/compare_em 5
	build/compare_em memory
	-OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 /usr/bin/python3 tests/bench/em_peers.py build/compare_em
	-PYTHONPATH=build/python /usr/bin/python3 tests/bench/python_step.py

# Other people's benchmarks, their data in MODEBANK_DATA: one table each, build/benchmarks/NAME.md; half an hour of a processor.
BENCHMARKS := $(notdir $(basename $(shell grep -l '^def main' tests/bench/benchmarks/*.py)))
benchmarks: $(BENCHMARKS:%=build/benchmarks/%.md)
build/benchmarks/%.md: build FORCE
	@mkdir -p build/benchmarks
	OMP_NUM_THREADS=1 /usr/bin/python3 tests/bench/benchmarks/$*.py build/modebank build/benchmarks/archives > $@.new && mv $@.new $@
	@cat $@
FORCE:

# Heading error after the gyro is lost, as docs/results/gyro_lost.md has it; five minutes of a processor.
gyro-lost: build/benchmarks/gyro_lost.md

# Switches that see state and input, on systems that are known, over seeds; MODEBANK_DATA as for benchmarks.
guards: build
	OMP_NUM_THREADS=1 /usr/bin/python3 tests/bench/measure_guards.py build/modebank

# Coverage of the stated 95 % regions, as docs/results/uncertainty.md has it.
uncertainty: bench-programs
	build/measure_coverage

# How often the true number of modes is found, as docs/results/mixture.md has it.
recovery: bench-programs
	build/measure_recovery

# How often modes of motion are claimed where there are none, and found where there are some; hours on two cores.
evidence: build
	OMP_NUM_THREADS=1 /usr/bin/python3 tests/bench/measure_evidence.py build/modebank --table docs/results/evidence.csv --revision $$(git log -1 --format=%h -- app filter ident io mixture)

# How often the rule on what a bank may add takes what is not there, and what is, as docs/results/rule.md has it; half an hour of two processors.
rule: bench-programs
	build/measure_rule 60 > docs/results/rule.csv
	/usr/bin/python3 tests/bench/rule_table.py docs/results/rule.csv

# How much is lost against the filter with the true parameters, on systems that are known; about three hours of a processor.
systems: build
	OMP_NUM_THREADS=1 /usr/bin/python3 tests/bench/measure_systems.py build/modebank

# Time and memory of five million rows and of ten thousand runs, as docs/results/scale.md has them; ten minutes of two processors and 10 GB of disk.
scale: build
	/usr/bin/python3 tests/bench/scale.py build/modebank build/scale

# Processor time against states, lags and samples, as docs/results/cost.md has it; half an hour of a processor.
cost: build
	OMP_NUM_THREADS=1 /usr/bin/python3 tests/bench/measure_cost.py build/modebank build/cost

# Which features of windows with many lags find the modes, as docs/results/mixture.md has it; ten minutes of a processor.
features: build
	OMP_NUM_THREADS=1 /usr/bin/python3 tests/bench/measure_features.py build/modebank build/features

# A robot's day through `modebank track`, killed every ten minutes of the log; docs/results/track.md.
track-day: demo
	/usr/bin/python3 tests/bench/track_day.py build/modebank $(DEMO)/demo.h5

# Bias and stated uncertainty on rounded outputs, by their intervals and as they stand.
quantised: build
	OMP_NUM_THREADS=1 /usr/bin/python3 tests/bench/measure_quantised.py build/modebank

# How often robots of known width, delays and noise lie within two standard errors of what `export --to ros2` says of them.
export-recovery: packages-build packages-test build/build.ninja
	cmake --preset release -DMODEBANK_BUILD_TESTS=ON >/dev/null
	cmake --build --preset release -j $(JOBS) --target test_export_recovery
	MODEBANK_EXPORT_SEEDS=1000 build/test_export_recovery

# The how-to's commands and lost nodes on a real Slurm of three nodes (slurmctld, slurmd, munge), which the test starts and ends.
slurm: packages-build packages-test packages-nightly build/build.ninja
	cmake --preset release -DMODEBANK_BUILD_TESTS=ON >/dev/null
	cmake --build --preset release -j $(JOBS) --target test_study_survival
	CI=true MODEBANK_STUDY_REPEATS=42 build/test_study_survival --gtest_filter='StudySlurm*:*TwentyKilledWorkers*'

# Studies of several machines on a file system without locks, with caches and other clocks; 40 machines are lost. Root, for mounts.
shared-fs: packages-build packages-test packages-nightly build/build.ninja
	cmake --preset release -DMODEBANK_BUILD_TESTS=ON >/dev/null
	cmake --build --preset release -j $(JOBS) --target test_shared_fs
	CI=true MODEBANK_SHARED_FS_ROUNDS=40 build/test_shared_fs

# Everything that CI runs beside `make test`; .ci/run times these one by one.
CHECKS := format lint shellcheck docs tidy-changed sanitize-short
.PHONY: list-checks
check: $(CHECKS)
list-checks:
	@echo $(CHECKS)

# Everything else, and `make` and `make test` on Debian 13; hours. Goes on after a failure. The table stands in build/nightly/table.md.
# STEPS="slurm arm64" runs these steps alone and keeps the results of the others.
.PHONY: nightly debian
nightly: packages-build packages-test packages-nightly
	tests/nightly $(STEPS)

# Tests with the label nightly_KIND: browser, slurm, shared_fs, faults, tutorials.
nightly-%: packages-nightly strict
	ctest --test-dir build -L '^nightly_$*$$' --no-tests=error --output-on-failure -j $(JOBS)

# README's two commands in an empty Debian: SUITE is trixie (Debian 13) or bookworm (Debian 12). If they fail, build/SUITE stays to look into.
SUITE := trixie
debian: packages-root
	@mkdir -p build
	git bundle create -q build/source.bundle HEAD
	packaging/with_root.sh $(SUITE) build/$(SUITE) tests/in_empty_debian.sh build/source.bundle

format: packages-check
	git ls-files '*.hpp' '*.cpp' '*.js' | xargs clang-format --dry-run --Werror

# The public headers' documentation, build/api/html; a warning is an error.
api: packages-check
	@mkdir -p build/api
	doxygen Doxyfile

# The pages of docs/, build/docs/index.html: built offline, a warning is an error; their spelling, and tables against their commands.
docs: packages-docs build api
	cmake --preset release -DMODEBANK_PYTHON=ON >/dev/null
	cmake --build --preset release -j $(JOBS) --target modebank_python
	/usr/bin/python3 -m sphinx -q -E -a -W --keep-going -b html docs build/docs
	/usr/bin/python3 docs/check_spelling.py README.md docs
	/usr/bin/python3 docs/check_results.py $(if $(wildcard $(DATA)/.),--data $(DATA)) docs/results/*.md

# The pages' search, as a reader uses it in Chromium.
.PHONY: docs-search
docs-search: docs packages-nightly
	/usr/bin/python3 docs/check_search.py build/docs

# What README and the tutorials print, run and compared; docs-update writes what is printed now into them.
DATA := $(or $(MODEBANK_DATA),../shared/data)
PAGES := README.md docs/tutorials/*.md
docs-examples docs-update: packages-test packages-nightly build
	cmake --preset release -DMODEBANK_PYTHON=ON >/dev/null
	cmake --build --preset release -j $(JOBS) --target modebank_python
	/usr/bin/python3 tests/docs/examples.py $(if $(findstring update,$@),--update) --data $(DATA) build $(PAGES)

# Words of the change's added lines (.ci/words). The pages' scripts: style, and types as their comments state them; NODE_PATH tells
# every node where Debian's modules are.
lint: packages-check
	.ci/check-words
	NODE_PATH=/usr/share/nodejs eslint --format unix app/report/web/src app/report/web/test
	tsc --project app/report/web/tsconfig.json

shellcheck: packages-check
	git ls-files '*.sh' .ci | xargs grep -lE '^#!.*\b(ba)?sh$$' | xargs shellcheck

# clang-tidy on every source, and on what changed; .ci/tidy says which these are.
tidy: packages-build packages-check
	.ci/tidy --all

tidy-changed: packages-build packages-check
	.ci/tidy

# The numeric tests of the libraries on 64-bit ARM, cross-compiled and run under qemu.
arm64: packages-build packages-arm64
	.ci/arm64

# The release build with benchmarks, warnings as errors; CI=true and `sanitize` make them errors, too.
strict: packages-build packages-test packages-bench
	cmake --preset release -DMODEBANK_WARNINGS_AS_ERRORS=ON -DMODEBANK_BUILD_TESTS=ON -DMODEBANK_BUILD_BENCHMARKS=ON -DMODEBANK_PYTHON=ON >/dev/null
	cmake --build --preset release -j $(JOBS)

# Recovery of known systems over many seeds.
seeds: packages-build packages-test build/build.ninja
	cmake --preset release -DMODEBANK_BUILD_TESTS=ON >/dev/null
	cmake --build --preset release -j $(JOBS)
	ctest --preset seeds -j $(JOBS)

# Address and undefined-behaviour sanitizers: io and the stepping of filters, what CI runs; and all tests.
.PHONY: sanitize-short
sanitize-short: packages-build packages-test
	cmake --preset sanitize >/dev/null
	cmake --build --preset sanitize -j $(JOBS) --target sanitize_short
	ctest --preset sanitize-short -j $(JOBS)

sanitize: packages-build packages-test
	cmake --preset sanitize >/dev/null
	cmake --build --preset sanitize -j $(JOBS)
	ctest --preset sanitize -j $(JOBS)

# Readers whose bytes we parse under libFuzzer: FUZZ_SECONDS for all together; its findings go to build/findings. `make nightly` takes a minute.
FUZZ_SECONDS ?= 600
fuzz: packages-build packages-test
	tests/fuzz/run $(FUZZ_SECONDS) $(JOBS)

# Every command on a disk that runs full at every one of its calls; `make nightly` takes a sample of them.
faults: packages-build packages-test build/build.ninja
	cmake --preset release -DMODEBANK_BUILD_TESTS=ON >/dev/null
	cmake --build --preset release -j $(JOBS) --target test_faults
	MODEBANK_FAULTS=all build/test_faults

coverage: packages-build packages-test
	cmake --preset coverage >/dev/null
	cmake --build --preset coverage -j $(JOBS)
	ctest --preset coverage -j $(JOBS)

# How evenly a page's plot follows a drag over a million samples; docs/results/speed.md.
page-drag: packages-nightly build
	/usr/bin/python3 tests/bench/page_drag.py build/modebank build/page_drag

# Pages of a study of 200 runs and of a million samples in Chromium; `make nightly` has all others, too.
pages-large: packages-nightly build
	/usr/bin/python3 tests/browser/pages_test.py build/modebank . build/pages_large LargePages

# A page of every kind in Debian's Firefox; `make nightly` has Chromium, too.
firefox: packages-firefox build
	/usr/bin/python3 tests/browser/firefox_test.py build/modebank . build/firefox

# README's picture: a held-out run of the demo.
picture: build
	build/modebank demo -o $(DEMO) --data.label mode
	/usr/bin/python3 docs/pictures/demo.py $(DEMO)/demo.h5 > docs/pictures/demo.svg

# configs/reference.ini: every key at its default.
reference-ini: build
	/usr/bin/python3 docs/reference_ini.py > configs/reference.ini

clean:
	rm -rf build
