# make            set the machine up and build build/item3d
# make demo       edit the demo model and say where its report is
# make test       check the format, test the loaders under sanitizers, test everything
# make bench      run the benchmarks of bench/ (docs/benchmarks.md says what they measure)
# make format     format all sources
# make lint       run clang-tidy on all sources (needs clang-tidy and libomp-dev)
# make install    install to PREFIX (default /usr/local)
# make clean      remove what was built; .deps/ stays
#
# JOBS=N limits how many compilers run at once.

PREFIX ?= /usr/local
# A file that includes LibTorch takes about 1.5 GB to compile.
JOBS ?= $(shell scripts/jobs.sh)

.DEFAULT_GOAL := build
.PHONY: setup configure build demo test test-loaders bench format check-format lint install clean

setup:
	@scripts/setup.sh

configure: setup
	@cmake --preset release --log-level=WARNING

build: configure
	@cmake --build --preset release --parallel $(JOBS) --target item3d parity

demo: build
	@build/item3d edit assets/demo/mug.glb --from "a red mug" --to "a golden mug" -o build/demo
	@echo "Open $(CURDIR)/build/demo/report.html"

check-format: setup
	@scripts/format.sh --check

test-loaders: setup
	@cmake --preset asan --log-level=WARNING
	@cmake --build --preset asan --parallel $(JOBS)
	@ctest --preset asan

test: check-format test-loaders
	@cmake --preset release --log-level=WARNING
	@cmake --build --preset release --parallel $(JOBS)
	@ctest --preset release

bench: configure
	@cmake --build --preset release --parallel $(JOBS)
	@scripts/bench.sh build

format: setup
	@scripts/format.sh

lint: configure
	@scripts/lint.sh

install: build
	@cmake --install build --prefix "$(PREFIX)"

clean:
	rm -rf build build-debug build-asan
