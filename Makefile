# make demo and make test are all a new machine needs; see README.md.
JOBS := $(shell nproc)
DEMO := build/demo

.PHONY: all build demo test bench uncertainty recovery check format strict seeds sanitize coverage picture readme clean

all: build

build/build.ninja: CMakeLists.txt CMakePresets.json | packages-build
	cmake --preset release >/dev/null

build: packages-build build/build.ninja
	cmake --build --preset release -j $(JOBS)

packages-%:
	@sh .ci/install-packages $*

# Simulates a robot on ice and grip with known truth and takes the whole chain over its runs.
demo: build
	@rm -rf $(DEMO)/data && mkdir -p $(DEMO)
	build/modebank simulate configs/simulate_ice.ini --simulate.output $(DEMO)/data
	build/modebank run configs/demo.ini --data.root $(DEMO)/data --archive.output $(DEMO)/demo.h5
	@echo "Look inside: build/modebank show $(DEMO)/demo.h5"

test: build packages-test
	ctest --preset release -j $(JOBS)

# The others compare window fits and EM with other people's, in Python too where it is installed.
bench: build
	build/bench_modebank
	build/compare_windows 5 build/compare_windows.bin
	build/compare_imm
	build/track_latency build/modebank
	-OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 /usr/bin/python3 tests/bench/window_peers.py build/compare_windows.bin
	OMP_NUM_THREADS=1 build/compare_em 5
	build/compare_em memory
	-OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 /usr/bin/python3 tests/bench/em_peers.py build/compare_em

# Coverage of the stated 95 % regions, as the README's table has it.
uncertainty: build
	build/measure_coverage

# How often the true number of modes is found, as the README's table has it.
recovery: build
	build/measure_recovery

# Everything CI runs beside `make test`.
check: format strict seeds sanitize

format: packages-check
	git ls-files '*.hpp' '*.cpp' | xargs clang-format --dry-run --Werror

# The release build again with warnings as errors; in CI it was built so already.
strict: packages-build
	cmake --preset release -DMODEBANK_WARNINGS_AS_ERRORS=ON >/dev/null
	cmake --build --preset release -j $(JOBS)

# Recovery of known systems over many seeds.
seeds: build
	ctest --preset seeds -j $(JOBS)

sanitize: packages-build packages-test
	cmake --preset sanitize >/dev/null
	cmake --build --preset sanitize -j $(JOBS)
	ctest --preset sanitize -j $(JOBS)

coverage: packages-build packages-test
	cmake --preset coverage >/dev/null
	cmake --build --preset coverage -j $(JOBS)
	ctest --preset coverage -j $(JOBS)

# README's pictures: two figures of the demo's report.
picture: demo packages-picture
	build/modebank report $(DEMO)/demo.h5 --report.figures $(DEMO)/figures --report.png true
	cp $(DEMO)/figures/local_models.png app/report/readme_local_models.png
	cp $(DEMO)/figures/estimates.png app/report/readme_estimates.png

# README's table of keys is what the program prints.
readme: build
	@build/modebank help --markdown > build/options.md
	@sed -i -e '/<!-- options -->/,/<!-- end of options -->/{//!d}' -e '/<!-- options -->/r build/options.md' README.md

clean:
	rm -rf build
