#!/bin/sh
# Writes the equations as C with 32-bit numbers, builds the loop, and prints what it takes of memory.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
appell derive unicycle --out unicycle.c --float --integrator >&2
arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 \
    -std=c99 -O2 -ffp-contract=off -ffunction-sections -fdata-sections -fstack-usage \
    -Wall -Wextra -Wconversion -Wdouble-promotion -Werror \
    -I. --specs=nano.specs -nostartfiles -T "$here/cortex-m4.ld" -Wl,--gc-sections \
    "$here/main.c" unicycle.c -lm -o loop.elf
arm-none-eabi-size loop.elf | awk 'NR == 2 {print "program", $1 + $2; print "data", $2 + $3}'
arm-none-eabi-nm --size-sort --print-size --radix=d loop.elf |
    awk '$4 == "unicycle_rates" {print "rates", $2 + 0} $4 == "unicycle_step" {print "step", $2 + 0}'
# The deepest chain: the loop, a step, the rates; sines and cosines need some more.
cat ./*.su | awk -F '[:\t]' '$4 ~ /^(main|unicycle_step|unicycle_rates)$/ {sum += $5} END {print "stack", sum}'
