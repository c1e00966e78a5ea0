# A new machine needs only `make demo` and `make test`; see README.md.
# Number of compilers: one per processor, but at most one for every 2.5 GB of free memory, since the largest sources
# take 2.3 GB.
JOBS := $(shell awk -v cores=$$(nproc) '/^MemAvailable/ { most = int($$2 / 2500000); print most < 1 ? 1 : most < cores ? most : cores }' /proc/meminfo)
DEMO := build/demo
PYTHON := /usr/bin/python3

.PHONY: all api build demo packages package-test dist dist-test pip-test test test-long bench-programs bench benchmarks uncertainty recovery evidence rule systems plants scale cost features check format lint shellcheck tidy tidy-changed seeds sanitize sanitize-short arm64 picture clean fuzz docs docs-examples docs-update reference-ini dev list-checks nightly debian house

all: build

# First configured for the program alone; `make test` and `make bench` add to the same folder.
PROGRAM_ALONE := $(if $(wildcard build/CMakeCache.txt),,-DMODEBANK_BUILD_TESTS=OFF -DMODEBANK_BUILD_BENCHMARKS=OFF)
build/build.ninja: CMakePresets.json | packages-build
	cmake --preset release $(PROGRAM_ALONE) >/dev/null

build: packages-build build/build.ninja
	cmake --build --preset release -j $(JOBS) --target modebank

packages-build:
	@sh .ci/install-packages build page

packages-%:
	@sh .ci/install-packages $*

# The program for development, build/dev/modebank: each source is compiled on its own, so that a changed line takes
# seconds.
build/dev/build.ninja: CMakePresets.json
	@$(MAKE) --no-print-directory packages-build
	cmake --preset dev >/dev/null
	@touch $@

dev: build/dev/build.ninja
	cmake --build --preset dev -j $(JOBS) --target modebank

# Simulates a robot on ice and grip with known truth, and runs the whole chain on its runs.
demo: build
	@rm -rf $(DEMO)
	build/modebank demo -o $(DEMO)

# Debian packages, build/packages/*.deb; package-test tries them in an empty Debian 12, which takes minutes.
packages: packages-build packages-package build/build.ninja
	cmake --preset release -DMODEBANK_PYTHON=ON >/dev/null
	rm -rf build/packages
	cmake --build --preset release -j $(JOBS) --target modebank_packages

package-test: packages packages-root
	packaging/test_packages.sh build/packages build/empty_root

# The program with its libraries, for any Linux with their glibc; dist-test tries it in an empty Debian 12 and 13.
dist: packages-build packages-dist build/build.ninja
	cmake --preset release >/dev/null
	cmake --build --preset release -j $(JOBS) --target modebank_dist

dist-test: dist packages-root
	packaging/test_dist.sh build/modebank-*.tar.gz build/empty_root

# Installs the Python module with pip in an empty Debian 12.
pip-test: packages-root
	packaging/test_pip.sh build/empty_root

# test: tests of at most 20 s each. test-long: the others, part of `make check`. The last lines name what was skipped.
test test-long: packages-build packages-test build/build.ninja
	cmake --preset release -DMODEBANK_BUILD_TESTS=ON -DMODEBANK_PYTHON=ON >/dev/null
	cmake --build --preset release -j $(JOBS)
	@status=0; ctest --preset $(if $(findstring long,$@),long,release) -j $(JOBS) --output-junit $(CURDIR)/build/$@.xml || status=$$?; \
	$(PYTHON) tests/skipped.py build/$@.xml || status=1; exit $$status

bench-programs: packages-build build/build.ninja
	cmake --preset release -DMODEBANK_BUILD_BENCHMARKS=ON >/dev/null
	cmake --build --preset release -j $(JOBS) --target modebank benchmarks

# Compares windows, filters and EM with other programs, in Python only where these are installed.
bench: bench-programs
	build/compare_windows 5
	build/compare_imm
	OMP_NUM_THREADS=1 build/compare_em 5
	build/compare_em memory
	-OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(PYTHON) tests/bench/em_peers.py build/compare_em

# Public benchmarks, with data in MODEBANK_DATA: one table each, build/benchmarks/NAME.md; half an hour of a processor.
BENCHMARKS := $(notdir $(basename $(shell grep -l '^def main' tests/bench/benchmarks/*.py)))
benchmarks: $(BENCHMARKS:%=build/benchmarks/%.md)
build/benchmarks/%.md: build FORCE
	@mkdir -p build/benchmarks
	OMP_NUM_THREADS=1 $(PYTHON) tests/bench/benchmarks/$*.py build/modebank build/benchmarks/archives > $@.new && mv $@.new $@
	@cat $@
FORCE:

# Coverage of the stated 95 % regions, for docs/results/simulated.md.
uncertainty: bench-programs
	build/measure_coverage

# How often the true number of modes is found, for docs/results/simulated.md.
recovery: bench-programs
	build/measure_recovery

# How often modes are claimed where there are none, and found where there are some; hours on two cores.
evidence: build
	OMP_NUM_THREADS=1 $(PYTHON) tests/bench/measure_evidence.py build/modebank --table build/evidence.csv --revision $$(git log -1 --format=%h -- app filter ident io mixture)

# How often the rule for additions to a bank accepts false ones, and true ones; half an hour of two processors.
rule: bench-programs
	build/measure_rule 60 > build/rule.csv
	$(PYTHON) tests/bench/rule_table.py build/rule.csv

# Loss against the filter with the true parameters, for known systems; about three hours of a processor.
systems: build
	OMP_NUM_THREADS=1 $(PYTHON) tests/bench/measure_systems.py build/modebank

# How often the linear stage is right about 400 simulated plants, and the whole program about 90 others: hours, but
# what is done is kept.
plants: build
	@status=0; for part in "" --whole; do \
	$(PYTHON) tests/bench/plants.py build/modebank --seed $(or $(SEED),1) $$part || status=1; done; exit $$status

# Time and memory of five million rows and of ten thousand runs, for docs/results/speed.md; ten minutes of two
# processors and 10 GB of disk.
scale: build
	$(PYTHON) tests/bench/scale.py build/modebank build/scale

# Processor time against states, lags and samples, for docs/results/speed.md; half an hour of a processor.
cost: build
	OMP_NUM_THREADS=1 $(PYTHON) tests/bench/measure_cost.py build/modebank build/cost

# Which features of windows with many lags find the modes, for docs/results/simulated.md; ten minutes of a processor.
features: build
	OMP_NUM_THREADS=1 $(PYTHON) tests/bench/measure_features.py build/modebank build/features

# Everything that CI runs beside `make test`; .ci/run times each of these.
CHECKS := test-long format lint shellcheck docs tidy-changed sanitize-short
check: $(CHECKS)
list-checks:
	@echo $(CHECKS)

# All other tests, and `make` and `make test` on Debian 13; hours. Continues after a failure. The table is
# build/nightly/table.md. STEPS="slurm arm64" runs only these steps and keeps the results of the others.
nightly: packages-build packages-test packages-check packages-nightly
	tests/nightly $(STEPS)

# Tests with the label nightly_KIND: browser, slurm, tutorials. Everything is built, benchmarks, too, and a
# warning is an error.
nightly-%: packages-build packages-test packages-check packages-nightly
	cmake --preset release -DMODEBANK_WARNINGS_AS_ERRORS=ON -DMODEBANK_BUILD_TESTS=ON -DMODEBANK_BUILD_BENCHMARKS=ON -DMODEBANK_PYTHON=ON >/dev/null
	cmake --build --preset release -j $(JOBS)
	ctest --test-dir build -L '^nightly_$*$$' --no-tests=error --output-on-failure -j $(JOBS)

# README's two commands in bare roots of Debian 12 and 13, or of one: SUITE=bookworm, SUITE=trixie; after a failure
# build/SUITE is kept.
SUITE := bookworm trixie
debian: packages-root
	tests/in_empty_debian.sh $(SUITE)

format: packages-check
	git ls-files '*.hpp' '*.cpp' '*.js' | xargs clang-format --dry-run --Werror

# Documentation of the public headers, build/api/html; a warning is an error.
api: packages-check
	@mkdir -p build/api
	doxygen Doxyfile

# The pages of docs/, build/docs/index.html: built offline, a warning is an error.
docs: packages-docs build api
	cmake --preset release -DMODEBANK_PYTHON=ON >/dev/null
	cmake --build --preset release -j $(JOBS) --target modebank_python
	$(PYTHON) -m sphinx -q -E -a -W --keep-going -b html docs build/docs

# Runs what README and the tutorials print and compares the output; docs-update writes the present output into them.
DATA := $(or $(MODEBANK_DATA),../shared/data)
PAGES := README.md docs/tutorials/*.md
docs-examples docs-update: packages-test packages-nightly build
	cmake --preset release -DMODEBANK_PYTHON=ON >/dev/null
	cmake --build --preset release -j $(JOBS) --target modebank_python
	$(PYTHON) tests/docs/examples.py $(if $(findstring update,$@),--update) --data $(DATA) build $(PAGES)

# Common misspellings, and style of the pages' scripts. NODE_PATH is where node finds
# Debian's modules.
WORDS_THAT_ARE_RIGHT := lenght,nd,nees,positionof,vell
lint: packages-check
	git ls-files '*.md' '*.[ch]' '*.[ch]pp' '*.py' '*.js' '*.css' '*.sh' '*.cmake' '*CMakeLists.txt' Makefile .ci | xargs codespell -q 3 -L $(WORDS_THAT_ARE_RIGHT)
	NODE_PATH=/usr/share/nodejs eslint --format unix app/report/web/src app/report/web/test

shellcheck: packages-check
	git ls-files '*.sh' .ci | xargs grep -lE '^#!.*\b(ba)?sh$$' | xargs shellcheck

# clang-tidy on every source, or on changed sources; .ci/tidy decides which these are.
tidy: packages-build packages-check
	.ci/tidy --all

tidy-changed: packages-build packages-check
	.ci/tidy

# Numeric tests of the libraries for 64-bit ARM, cross-compiled and run under qemu.
arm64: packages-build packages-arm64
	.ci/arm64

# Recovery of known systems over many seeds.
seeds: packages-build packages-test build/build.ninja
	cmake --preset release -DMODEBANK_BUILD_TESTS=ON >/dev/null
	cmake --build --preset release -j $(JOBS)
	ctest --test-dir build -L '^seeds$$' --output-on-failure -j $(JOBS)

# Address and undefined-behaviour sanitizers: sanitize-short tests io and the filters' steps, as CI does; sanitize runs
# all tests.
sanitize-short: packages-build packages-test
	cmake --preset sanitize >/dev/null
	cmake --build --preset sanitize -j $(JOBS) --target sanitize_short
	ctest --preset sanitize-short -j $(JOBS)

sanitize: packages-build packages-test
	cmake --preset sanitize >/dev/null
	cmake --build --preset sanitize -j $(JOBS)
	ctest --preset sanitize -j $(JOBS)

# libFuzzer on the readers of bytes. FUZZ_SECONDS: time for all together; findings go to build/findings. `make nightly`
# takes a minute.
FUZZ_SECONDS ?= 600
fuzz: packages-build packages-test
	tests/fuzz/run $(FUZZ_SECONDS) $(JOBS)

# The picture of docs/index.md: a held-out run of the demo.
picture: build
	build/modebank demo -o $(DEMO)
	$(PYTHON) docs/pictures/demo.py $(DEMO)/demo.h5 > docs/pictures/demo.svg

# configs/reference.ini: every key at its default.
reference-ini: build
	$(PYTHON) docs/reference_ini.py > configs/reference.ini

# tests/house.csv: lines, files and tokens of each room, which the test Structure checks.
house:
	$(PYTHON) tests/house.py

clean:
	rm -rf build
