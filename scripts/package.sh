#!/usr/bin/env bash
# Packages a build for Linux on x86-64 with any version of glibc. A package contains the programs, LibTorch, all
# libraries that they need (with the C library), the assets, and the licences of all these parts.
#
# usage: scripts/package.sh BUILD [archive|deb|wheel]...    default: all three kinds
#
# The packages are written to BUILD/packages:
#
#   item3d-VERSION-linux-x86_64.tar.zst      archive to unpack into any folder; the program is bin/item3d
#   item3d_VERSION_amd64.deb                 Debian package that installs to /opt/item3d, with a link in /usr/bin
#   item3d_program-VERSION-py3-none-...whl   Python package that puts item3d on PATH
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=$(realpath "${1:?usage: scripts/package.sh BUILD [archive|deb|wheel]...}")
shift
kinds=("$@")
((${#kinds[@]})) || kinds=(archive deb wheel)
version=$(sed -n "s/^CMAKE_PROJECT_VERSION:STATIC=//p" "$build/CMakeCache.txt")
packages=$build/packages
tree=$packages/item3d-$version-linux-x86_64

fail() {
    echo "package: error: $*" >&2
    exit 1
}
need() {
    command -v "$1" >/dev/null || fail "$1 is not there; apt-get install $2"
}

# ------------------------------------------------------------------------------ Folder with all files
# Prints the shared libraries that the dynamic loader finds for the programs, as lines "SONAME PATH".
libraries() {
    find "$tree/lib/item3d" -maxdepth 2 -type f -exec ldd {} + 2>/dev/null |
        awk '$2 == "=>" && $3 ~ /^\// { print $1, $3 } $1 ~ /^\/.*ld-linux/ { print "ld-linux-x86-64.so.2", $1 }' |
        sort -u
}

# Prints the Debian package of a file. /lib is a link to /usr/lib, and packages may list a file under either path.
package_of() {
    dpkg-query -S "$1" 2>/dev/null || dpkg-query -S "/usr$1" 2>/dev/null || dpkg-query -S "${1#/usr}" 2>/dev/null
}

collect_libraries() {
    local system=$tree/lib/item3d/system name path package
    mkdir -p "$system"
    while read -r name path; do
        [[ -e $tree/lib/item3d/$name ]] && continue
        cp -L "$path" "$system/$name"
        package=$(package_of "$(realpath "$path")" | head -n 1 | cut -d : -f 1) || fail "no package has $path"
        mkdir -p "$tree/share/doc/item3d/licences"
        cp "/usr/share/doc/$package/copyright" "$tree/share/doc/item3d/licences/$package.txt"
    done < <(libraries)
    strip --strip-unneeded "$system"/*.so* 2>/dev/null || true
    chmod +x "$system/ld-linux-x86-64.so.2"
}

# Collects the licences of all parts in share/doc/item3d/licences, with an index. The libraries of Debian are already
# there. They refer to the texts in common-licenses, which only Debian has at a known place.
collect_licences() {
    local licences=$tree/share/doc/item3d/licences file name
    cp .deps/xatlas/LICENSE "$licences/xatlas.txt"
    cp .deps/basis_universal/LICENSE "$licences/basis_universal.txt"
    cp "$tree/share/item3d/web/three/LICENSE" "$licences/three.txt"
    for name in libglm-dev libstb-dev nlohmann-json3-dev libcli11-dev libcpp-httplib-dev; do
        cp "/usr/share/doc/$name/copyright" "$licences/$name.txt"
    done
    while read -r file; do
        name=${file#.deps/site/}
        mkdir -p "$licences/$(dirname "${name/.dist-info/}")"
        cp "$file" "$licences/${name/.dist-info/}"
    done < <(find .deps/site -path '*.dist-info/*' -type f)
    compgen -G "$licences/nvidia_cuda_runtime*" >/dev/null ||
        fail "licences of NVIDIA's libraries are missing; remove .deps/site and run scripts/setup.sh"
    mkdir -p "$licences/common-licenses"
    cp -L /usr/share/common-licenses/* "$licences/common-licenses"
    {
        cat <<TEXT
item3d itself is under the Apache License 2.0 (../LICENSE). These files are the licences of the other parts of the package:

  torch-*            LibTorch (lib/item3d/libtorch_cpu.so, libc10.so, libgomp.so.1) and the parts that it contains
  nvidia_cuda_*      lib/item3d/libcudart.so and libcupti.so, with which LibTorch is linked; no GPU code is used
  xatlas, basis_universal, three, and the headers glm, stb, nlohmann-json, CLI11 and cpp-httplib
  all other .txt     a library of Debian in lib/item3d/system; the texts to which they refer are in common-licenses

The sources of the libraries of Debian are at https://snapshot.debian.org, in these versions:

TEXT
        for file in "$licences"/*.txt; do
            name=$(basename "$file" .txt)
            dpkg-query -W -f '  ${Package} ${Version} (source ${source:Package} ${source:Version})\n' "$name" 2>/dev/null || true
        done | sort -u
    } >"$licences/README.txt.new"
    mv "$licences/README.txt.new" "$licences/README.txt"
}

make_tree() {
    rm -rf "$tree"
    cmake --install "$build" --prefix "$tree" --component programs --strip >/dev/null
    install -s "$build/item3d_static" "$tree/bin/item3d"
    local program
    mkdir "$tree/lib/item3d/programs"
    for program in "$tree"/lib/item3d/item3d-*; do
        mv "$program" "$tree/lib/item3d/programs"
        ln "$tree/bin/item3d" "$program"
    done
    mv "$tree"/lib/item3d/libitem3d_*.so "$tree/lib/item3d/programs"
    collect_libraries
    cp LICENSE README.md CHANGELOG.md "$tree/share/doc/item3d"
    mkdir "$tree/share/doc/item3d/docs"
    (cd docs && find . -name '*.md' -not -path './journal/*' -exec cp --parents {} "$tree/share/doc/item3d/docs" \;)
    collect_licences
}

# ------------------------------------------------------------------------------ The three kinds of packages
make_archive() {
    need zstd zstd
    tar --sort=name --owner=0 --group=0 --numeric-owner -C "$packages" -cf - "$(basename "$tree")" |
        zstd -q -19 -T0 --long=27 -f -o "$tree.tar.zst"
    ls -l "$tree.tar.zst"
}

make_deb() {
    need dpkg-deb dpkg
    local root=$packages/deb
    rm -rf "$root"
    mkdir -p "$root/DEBIAN" "$root/opt" "$root/usr/bin" "$root/usr/share/doc/item3d"
    cp -al "$tree" "$root/opt/item3d"
    ln -s /opt/item3d/bin/item3d "$root/usr/bin/item3d"
    # The system looks for man pages and completions in /usr/share.
    local file
    for file in man/man1 bash-completion/completions zsh/site-functions fish/vendor_completions.d; do
        mkdir -p "$root/usr/share/$file"
        cp -L "$tree/share/$file"/* "$root/usr/share/$file"
    done
    { cat LICENSE && echo && cat "$tree/share/doc/item3d/licences/README.txt"; } >"$root/usr/share/doc/item3d/copyright"
    cat >"$root/DEBIAN/control" <<CONTROL
Package: item3d
Version: $version
Architecture: amd64
Maintainer: item3d
Section: graphics
Priority: optional
Installed-Size: $(du -sk "$tree" | cut -f 1)
Description: edits the look of textured 3D models from two sentences
 item3d changes the materials of a model, such as "a red mug" to "a golden mug".
 It also relights models, and reconstructs them from photographs. The package
 brings every library that it needs and depends on no other package.
CONTROL
    dpkg-deb --root-owner-group -Zxz -z6 --build "$root" "$packages/item3d_${version}_amd64.deb" >/dev/null
    rm -rf "$root"
    ls -l "$packages/item3d_${version}_amd64.deb"
}

make_wheel() {
    need python3 python3
    python3 scripts/package_wheel.py "$tree" "$version" "$packages"
    ls -l "$packages"/item3d_program-"$version"-*.whl
}

mkdir -p "$packages"
make_tree
for kind in "${kinds[@]}"; do
    case $kind in
    archive | deb | wheel) "make_$kind" ;;
    *) fail "there is no kind '$kind': archive, deb, wheel" ;;
    esac
done
# `sha256sum -c` checks downloaded packages by this file.
(cd "$packages" && find . -maxdepth 1 -name "item3d*$version*" -type f -printf '%f\n' | sort | xargs sha256sum >SHA256SUMS)
