# make demo and make test are all a new machine needs; see README.md.
JOBS := $(shell nproc)
DEMO := build/demo

.PHONY: all build demo test bench check format tidy strict sanitize coverage picture clean

all: build

build/build.ninja: CMakeLists.txt CMakePresets.json | packages-build
	cmake --preset release >/dev/null

build: packages-build build/build.ninja
	cmake --build --preset release -j $(JOBS)

packages-%:
	@sh .ci/install-packages $*

# Simulates ice-like runs with known truth and takes the whole chain over them.
demo: build
	@mkdir -p $(DEMO)
	build/modebank simulate configs/simulate_ice.ini --simulate.output $(DEMO)/data
	build/modebank run configs/demo.ini --data.root $(DEMO)/data --archive.output $(DEMO)/demo.h5
	@echo "Look inside: build/modebank show $(DEMO)/demo.h5"

test: build packages-test
	ctest --preset release -j $(JOBS)

bench: build
	build/bench_modebank

# Everything CI runs beside `make test`.
check: format strict sanitize tidy

format: packages-check
	git ls-files '*.hpp' '*.cpp' | xargs clang-format --dry-run --Werror

# The release build again with warnings as errors; in CI it was built so already.
strict: packages-build
	cmake --preset release -DMODEBANK_WARNINGS_AS_ERRORS=ON >/dev/null
	cmake --build --preset release -j $(JOBS)

sanitize: packages-build packages-test
	cmake --preset sanitize >/dev/null
	cmake --build --preset sanitize -j $(JOBS)
	ctest --preset sanitize -j $(JOBS)

tidy: strict packages-check
	git ls-files '*.cpp' | grep -v '^tests/' | xargs -P $(JOBS) -n 1 clang-tidy --quiet -p build

coverage: packages-build packages-test
	cmake --preset coverage >/dev/null
	cmake --build --preset coverage -j $(JOBS)
	ctest --preset coverage -j $(JOBS)

picture: demo packages-picture
	/usr/bin/python3 app/report/readme_picture.py $(DEMO)/demo.h5 app/report/readme.png

clean:
	rm -rf build
