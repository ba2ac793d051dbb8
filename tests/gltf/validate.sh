#!/usr/bin/env bash
# validate.sh FILE: the validator's report as JSON. Exit 77 when node or the validator cannot be had.
set -uo pipefail
cd "$(dirname "$0")"
command -v node >/dev/null && command -v npm >/dev/null || exit 77
if [ ! -d node_modules/gltf-validator ]; then
  npm ci --silent --no-audit --no-fund >/dev/null 2>&1 || exit 77
fi
exec node validate.mjs "$1"
