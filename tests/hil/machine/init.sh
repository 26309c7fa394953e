#!/bin/sh
# First process of the uml machine, on a read-only view of the outer machine's root:  init.sh
# Makes a root that can be written to and thrown away, loads the modules, and lets inside.py do the rest; it becomes
# systemd first, whose unit that is, where the order says so.
# Beside this file, in the control directory: shared (directories to write to, one a line), start (a shell script that
# runs inside.py), systemd (a link to it, or nothing). It says what went wrong on the console, which is
# the kernel log of the run.
control=${0%/*}
PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
export PATH

off() {
    sync
    echo o >/proc/sysrq-trigger
    sleep 60
}
bad() {
    echo "init: $*"
    off
}

mount -t proc proc /proc || bad "no /proc"
# Debian's kernel keeps this in modules; a kernel with all of it built in has no such directory.
modules=/usr/lib/uml/modules/$(uname -r)
grep -qw overlay /proc/filesystems || insmod "$modules/kernel/fs/overlayfs/overlay.ko" || bad "no overlay"

mount -t tmpfs -o mode=755 tmpfs /run || bad "no tmpfs"
root=/run/root
mkdir /run/upper /run/work $root
mount -t overlay -o lowerdir=/,upperdir=/run/upper,workdir=/run/work overlay $root || bad "cannot mount the overlay"
mount -t proc proc $root/proc
mount -t sysfs sysfs $root/sys
mount -t devtmpfs devtmpfs $root/dev
mkdir -p $root/dev/shm $root/dev/pts
mount -t tmpfs -o mode=1777 tmpfs $root/dev/shm
mount -t devpts devpts $root/dev/pts
ln -sf /proc/self/fd $root/dev/fd
ln -sf /proc/self/fd/0 $root/dev/stdin
ln -sf /proc/self/fd/1 $root/dev/stdout
ln -sf /proc/self/fd/2 $root/dev/stderr
if [ -d "$modules" ]; then
    mkdir -p $root/lib/modules
    mount -t hostfs -o "${modules%/*}" none $root/lib/modules || bad "cannot share the modules"
fi
while IFS= read -r directory; do
    mount -t hostfs -o "$directory" none "$root$directory" || bad "cannot share $directory"
done <"$control/shared"
[ ! -e "$control/systemd" ] || mount -t tmpfs -o mode=755 tmpfs $root/run || bad "no tmpfs"
mkdir -p "$root/run/machine"
mount -t hostfs -o "$control" none $root/run/machine || bad "cannot share $control"

# The new root for good: under a mere chroot the command could not make user namespaces.
cd $root && pivot_root . . && umount -l . && cd / || bad "cannot change the root"
hostname localhost
if [ -d "$modules" ]; then
    modprobe can-raw && modprobe vcan echo=1 || bad "cannot load the CAN modules"
fi
if [ -e /run/machine/systemd ]; then
    # Nothing of what the outer machine starts, mounts or waits for.
    mount -t tmpfs -o mode=755 tmpfs /etc/systemd/system && : >/etc/fstab || bad "no tmpfs"
    # Where the outer machine is a container: this one is none.
    rm -f /.dockerenv /run/.containerenv
    # It would empty /tmp, and directories there may be shared.
    ln -s /dev/null /etc/systemd/system/systemd-tmpfiles-setup.service
    cat >/etc/systemd/system/machine.service <<END
[Unit]
Description=What the machine is for
[Service]
ExecStart=/bin/sh /run/machine/start
ExecStopPost=/bin/sh -c "sync; echo o >/proc/sysrq-trigger"
LimitNOFILE=4096
END
    exec /run/machine/systemd --unit=machine.service
fi
ulimit -n 4096
/bin/sh /run/machine/start
off
