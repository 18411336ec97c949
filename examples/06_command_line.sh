#!/usr/bin/env bash
# The command line: what a file holds, which adapters there are, and a picture. Give it any BCC, glTF or USD file of curves;
# what follows the folder goes to `lisle render`.
set -euo pipefail
input=${1:?usage: 06_command_line.sh FILE [FOLDER [OPTIONS]]}
out=${2:-out/examples}
mkdir -p "$out"

lisle devices
lisle info "$input"
lisle render "$input" -o "$out/picture.png" --size 1280x960 --samples 16 --yarn cotton-1 --material cotton "${@:3}"
