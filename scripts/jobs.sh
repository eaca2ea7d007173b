#!/usr/bin/env bash
# Prints the number of compilers to run in parallel: one for each core, but at most one for each 1.7 GB of free memory.
cores=$(nproc 2>/dev/null || echo 2)
kilobytes=$(awk '/^MemAvailable:/ { print $2 }' /proc/meminfo 2>/dev/null)
fitting=$((${kilobytes:-4000000} / 1700000))
jobs=$((fitting < cores ? fitting : cores))
echo $((jobs > 0 ? jobs : 1))
