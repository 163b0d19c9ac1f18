#!/usr/bin/env bash
# run.sh BUILD SOURCE: installs the build into a folder of its own, runs the installed program from elsewhere, and builds
# and runs a project that finds the package.
set -euo pipefail
build=$1 source=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
cmake --install "$build" --prefix "$place/usr" >"$place/install.log"
cd "$place"
usr/bin/heartservo scene scenes/pig_2007.yaml
usr/bin/heartservo doctor | grep -q "share/heartservo/scenes"
usr/bin/heartservo servo scenes/pig_2007.yaml --frames 12 --no-video --quiet --out run
cmake -S "$source" -B project -DCMAKE_PREFIX_PATH="$place/usr" -DCMAKE_BUILD_TYPE=Release >configure.log ||
  { cat configure.log; exit 1; }
cmake --build project
project/tracks_a_frame
bash -c 'source usr/share/bash-completion/completions/heartservo
  PATH=$PWD/usr/bin:$PATH
  COMP_WORDS=(heartservo ser) COMP_CWORD=1; _heartservo; [[ ${COMPREPLY[*]} == servo ]]
  COMP_WORDS=(heartservo servo --trac) COMP_CWORD=2; _heartservo; [[ ${COMPREPLY[*]} == --tracker ]]'
echo "the package works"
