#!/usr/bin/env bash
# How many compilers may run at once: one for each core, but no more than memory allows (1.7 GB each).
cores=$(nproc 2>/dev/null || echo 2)
kilobytes=$(awk '/^MemAvailable:/ { print $2 }' /proc/meminfo 2>/dev/null)
fitting=$((${kilobytes:-4000000} / 1700000))
jobs=$((fitting < cores ? fitting : cores))
echo $((jobs > 0 ? jobs : 1))
