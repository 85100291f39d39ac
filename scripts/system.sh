# Sourced by setup.sh: the few steps that change the machine outside the checkout.

say() { printf 'setup: %s\n' "$*"; }
warn() { printf 'setup: WARNING: %s\n' "$*" >&2; }
die() { printf 'setup: %s\n' "$*" >&2; exit 1; }

# Root runs the command, anyone else goes through sudo (which may ask, if there is a terminal).
as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    elif [ -t 0 ]; then
        sudo "$@"
    else
        sudo -n "$@"
    fi
}

may_change_system() {
    [ "${RTPHYS_SETUP:-}" != venv ] || { warn "RTPHYS_SETUP=venv: skipping"; return 1; }
    command -v apt-get >/dev/null || { warn "no apt-get here: install by hand"; return 1; }
    [ "$(id -u)" = 0 ] && return
    command -v sudo >/dev/null || { warn "not root and no sudo"; return 1; }
    [ -t 0 ] || sudo -n true 2>/dev/null || { warn "not root, and sudo wants a password"; return 1; }
}

apt_get() {
    as_root env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300 "$@" </dev/null
}

# install_packages REASON PACKAGE…   (apt options may stand among the packages)
install_packages() {
    local reason=$1
    shift
    say "system-wide step: $reason; apt-get install $*"
    may_change_system || die "without permission for that step; ask an administrator to run: apt-get install $*"
    refresh_lists
    apt_get install -y --no-install-recommends "$@" >/dev/null 2>&1 ||
        { warn "apt-get install $* failed"; return 1; }
}

refresh_lists() {
    [ -n "${lists_fresh:-}" ] || apt_get update || warn "apt-get update failed; trying with the old lists"
    lists_fresh=1
}

# The distribution's Mesa, or the backport where the distribution's is too old: SAPIEN needs
# descriptorBindingPartiallyBound on the CPU device, which Mesa has from 23.1 on.
install_driver() {
    say "no working Vulkan device found; the CPU one (Mesa's lavapipe) will do"
    may_change_system || return 1
    refresh_lists
    local candidate
    candidate=$(apt-cache policy mesa-vulkan-drivers | sed -n 's/ *Candidate: //p')
    if dpkg --compare-versions "${candidate:-0}" ge 23.1; then
        install_packages "a Vulkan driver is missing" mesa-vulkan-drivers
        return
    fi
    local release
    release=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    [ "$release" = bookworm ] || {
        warn "this release offers Mesa ${candidate:-none}, and 23.1 is needed"
        return 1
    }
    add_backports bookworm
    install_packages "a Vulkan driver is missing, and this release's Mesa $candidate is too old" \
        -t bookworm-backports mesa-vulkan-drivers
}

# add_backports RELEASE: the same mirror and key that the machine already uses for RELEASE.
add_backports() {
    local release=$1 file=/etc/apt/sources.list.d/rtphys-backports.sources mirror key
    apt-cache policy | grep -q "n=$release-backports" && return
    mirror=$(apt-get indextargets --format '$(REPO_URI) $(CODENAME) $(ORIGIN)' 'Created-By: Packages' |
        awk -v want="$release" '$2 == want && $3 == "Debian" { print $1; exit }')
    [ -n "$mirror" ] || die "no apt source for $release found to take the backports from"
    key=/usr/share/keyrings/debian-archive-keyring.gpg
    say "system-wide step: adding $release-backports of your mirror (nothing else is taken from it);"
    say "  undo by removing $file"
    {
        printf 'Types: deb\nURIs: %s\nSuites: %s-backports\nComponents: main\n' "$mirror" "$release"
        if [ -f "$key" ]; then printf 'Signed-By: %s\n' "$key"; fi
    } | as_root tee "$file" >/dev/null
    apt_get update || warn "apt-get update failed"
}
