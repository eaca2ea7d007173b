# make            set the machine up and build all programs
# make demo       edit the demo model and print where its report is
# make studio     build item3d studio and open it on the demo model
# make test       check format and layers, test the loaders under sanitizers, build and test everything
# make test-slurm run a batch on a Slurm of two nodes that is started on this machine (needs slurm-wlm and munge)
# make check      build, and run the tests without whole edits
# make test-browser   test all of item3d studio in Chromium (make test runs a short version)
# make test-blender   test the extension for Blender in the versions of scripts/blender.txt (fetches up to 900 MB)
# make blender-extension   write the extension as a zip into build/packages
# make test-python    build the Python package and run its tests (fetches PyTorch for Python, 3 GB)
# make test-agents    run `item3d mcp` with the client of the protocol's SDK (fetches 13 MB)
# make fuzz       fuzz the readers for FUZZ_SECONDS each (needs clang, libclang-rt-14-dev and libomp-dev; scripts/fuzz.sh)
# make test-sanitized  run all tests under the address and undefined-behaviour sanitizers, and test-threads (about two hours)
# make test-threads  test readers, writers, servers and kernels under the thread sanitizer
# make torture    kill, cut off and starve the commands for TORTURE_MINUTES (needs a C compiler; bench/torture)
# make wheel      write the Python package as a wheel into build/wheels
# make reference  generate docs/reference and web/settings.json from the programs
# make docs       write the docs as pages with search, build/docs/index.html (fetches 31 MB)
# make cuda       build the kernels for CUDA devices too (fetches a compiler of 180 MB)
# make bench      run the benchmarks of bench/ (docs/benchmarks.md says what they measure)
# make format     format all sources
# make lint       run clang-tidy on all sources (needs clang-tidy and libomp-dev)
# make install    install to PREFIX (default /usr/local)
# make package    write an archive, a .deb and a wheel that run on any Linux of x86-64 (scripts/package.sh)
# make clean      remove what was built; .deps/ stays
#
# JOBS=N limits how many compilers run at once.

PREFIX ?= /usr/local
# Compiling a file that includes LibTorch takes about 1.7 GB of memory.
JOBS ?= $(shell scripts/jobs.sh)

.DEFAULT_GOAL := build
.PHONY: setup configure build demo studio fuzz torture test-browser test-python test-agents wheel check-format check-layers test-loaders test-threads test-sanitized test-build test test-slurm test-blender blender-extension check docs reference cuda \
    bench bench-build format lint install package clean
BUILD := cmake --build --preset release --parallel $(JOBS)
# scripts/setup.sh fetches nvcc for x86-64 only.
CUDA := $(if $(filter x86_64,$(shell uname -m)),cuda)

setup:
	@scripts/setup.sh

configure: setup
	@cmake --preset release --log-level=WARNING

build: configure
	@$(BUILD) --target item3d item3d-edit item3d-reconstruct item3d-train item3d-bench item3d-compare item3d-study item3d-studio item3d_ktx2 item3d_manual

reference: build
	@$(BUILD) --target test_edit
	@ITEM3D_WRITE_DOCS=1 build/test_edit --gtest_brief=1 --gtest_filter='EditSettings.AreAs*'
	@scripts/reference.py build docs

demo: configure
	@$(BUILD) --target item3d item3d-edit
	@build/item3d edit assets/demo/mug.glb --from "a red mug" --to "a golden mug" -o build/demo
	@echo "Open $(CURDIR)/build/demo/report.html"

studio: configure
	@$(BUILD) --target item3d item3d-edit item3d-studio
	@build/item3d studio assets/demo/mug.glb

check-format: setup
	@scripts/format.sh --check

check-layers:
	@scripts/layers.py

test-loaders: setup
	@cmake --preset asan --log-level=WARNING
	@cmake --build --preset asan --parallel $(JOBS)
	@ctest --preset asan

test-threads: setup
	@cmake --preset threads --log-level=WARNING
	@cmake --build --preset threads --parallel $(JOBS)
	@ctest --preset threads
	@cmake --preset threads-tensors --log-level=WARNING
	@cmake --build --preset threads-tensors --parallel $(JOBS)
	@ctest --preset threads-tensors
	@ctest --preset threads-edit

test-sanitized: test-threads
	@cmake --preset sanitized --log-level=WARNING
	@cmake --build --preset sanitized --parallel $(JOBS)
	@ctest --preset sanitized

FUZZ_SECONDS ?= 60
fuzz: setup
	@cmake --preset fuzz --log-level=WARNING
	@cmake --build --preset fuzz --target fuzz_targets --parallel $(JOBS)
	@scripts/fuzz.sh $(FUZZ_SECONDS)

TORTURE_MINUTES ?= 60
TORTURE ?=
torture: build
	@python3 bench/torture build/item3d build/torture --minutes $(TORTURE_MINUTES) \
	    --numbers models lights weights layers --sizes "one triangle" $(TORTURE)

test-build:
	@scripts/setup.sh $(CUDA) browser
	@cmake --preset release --log-level=WARNING $(if $(CUDA),-DITEM3D_CUDA=ON)
	@$(BUILD)

test: check-format check-layers test-loaders test-build
	@ctest --preset release

test-slurm: build
	@scripts/slurm_test.sh build

check: configure
	@$(BUILD)
	@ctest --preset release --label-exclude whole

test-browser:
	@scripts/setup.sh browser
	@cmake --preset release --log-level=WARNING
	@$(BUILD) --target item3d item3d-edit item3d-studio
	@tests/browser/studio.py build/item3d --all

test-blender:
	@scripts/setup.sh blender
	@cmake --preset release --log-level=WARNING
	@$(BUILD) --target item3d item3d-edit
	@scripts/test_blender.sh build/item3d

blender-extension:
	@scripts/blender_extension.py build/packages

# Folder with PyTorch, pytest and scikit-build-core for python3.
PYTHON_SITE ?= $(CURDIR)/.deps/python
PYTHON_PACKAGE := $(CURDIR)/build/python-package
EMULATED := $(CURDIR)/build/python-emulated

test-python:
	@$(if $(filter $(CURDIR)/.deps/python,$(PYTHON_SITE)),scripts/setup.sh python diffusers)
	@rm -rf $(PYTHON_PACKAGE)
	@PYTHONPATH=$(PYTHON_SITE) python3 -m pip install -q --no-build-isolation --no-deps --no-index \
	    --disable-pip-version-check --root-user-action=ignore --target $(PYTHON_PACKAGE) .
	@PYTHONPATH=$(PYTHON_PACKAGE):$(PYTHON_SITE):.deps/diffusers $(if $(wildcard build/item3d),ITEM3D_PROGRAM=$(CURDIR)/build/item3d) \
	    python3 -m pytest -q -p no:cacheprovider python/tests
	@# The operators' code for CUDA devices, with a device that the tests emulate.
	@PATH=$(PYTHON_SITE)/bin:$$PATH cmake -S python -B $(EMULATED) -G Ninja --log-level=WARNING
	@PATH=$(PYTHON_SITE)/bin:$$PATH cmake --build $(EMULATED) --target item3d_operators_emulated
	@rm -rf $(EMULATED)/package && mkdir -p $(EMULATED)/package && cp -r $(PYTHON_PACKAGE)/item3d $(EMULATED)/package
	@cp $(EMULATED)/item3d_operators_emulated.so $(EMULATED)/package/item3d/_operators.so
	@PYTHONPATH=$(EMULATED)/package:$(PYTHON_SITE) $(if $(wildcard build/item3d),ITEM3D_PROGRAM=$(CURDIR)/build/item3d) \
	    python3 -m pytest -q -p no:cacheprovider \
	    $(addprefix python/tests/test_,$(addsuffix .py,antialias interpolate model nvdiffrast prefilter rasterize render shade texture))

test-agents:
	@scripts/setup.sh agents
	@cmake --preset release --log-level=WARNING
	@$(BUILD) --target item3d item3d-edit item3d-studio
	@PYTHONPATH=$(CURDIR)/.deps/agents python3 tests/mcp/client.py build/item3d

wheel: setup
	@$(if $(filter $(CURDIR)/.deps/python,$(PYTHON_SITE)),scripts/setup.sh python auditwheel,scripts/setup.sh auditwheel)
	@rm -rf build/wheels
	@PYTHONPATH=$(PYTHON_SITE) python3 -m pip wheel -q --no-build-isolation --no-deps --no-index \
	    --disable-pip-version-check -w build/wheels/linux .
	@PYTHONPATH=.deps/auditwheel PATH=$(CURDIR)/.deps/auditwheel/bin:$$PATH python3 -m auditwheel repair \
	    --plat manylinux_2_28_x86_64 --exclude 'libtorch*.so' --exclude 'libc10*.so' --exclude 'libcudart*' -w build/wheels \
	    build/wheels/linux/*.whl 2>build/wheels/auditwheel.log || (cat build/wheels/auditwheel.log; exit 1)
	@ls build/wheels/item3d-*.whl

docs:
	@scripts/setup.sh docs
	@NO_MKDOCS_2_WARNING=1 PYTHONPATH=$(CURDIR)/.deps/docs python3 -m mkdocs build --strict --clean
	@echo "Open $(CURDIR)/build/docs/index.html"

cuda:
	@scripts/setup.sh cuda
	@cmake --preset release --log-level=WARNING -DITEM3D_CUDA=ON
	@$(BUILD) --target item3d_cuda

bench-build: configure
	@$(BUILD) --target benches parity

bench: bench-build
	@scripts/bench.sh build

format: setup
	@scripts/format.sh

lint: configure
	@scripts/lint.sh

install: build
	@$(BUILD) --target parity rooms
	@cmake --install build --prefix "$(PREFIX)"

package: build
	@$(BUILD) --target item3d_static
	@scripts/package.sh build

clean:
	rm -rf build build-debug build-asan build-fuzz build-sanitized build-threads build-threads-tensors
