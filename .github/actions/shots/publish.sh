#!/usr/bin/env bash
# publish.sh -- put pictures into a folder of a branch: bash publish.sh REPORT BRANCH FOLDER
#
# The branch has no other history than its pictures; it is begun where there is none, and the
# folders of the oldest runs go when there are more than 50. Another job may push meanwhile:
# it is tried again on top of that.
set -euo pipefail
report=$1 branch=$2 folder=$3
most=50

origin=$(git remote get-url origin)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
git init --quiet "$work"
git -C "$work" remote add origin "$origin"
# The token of actions/checkout is in the configuration of its clone: in a file of its own since v6.
header=$(git config --get-regexp '^http\..*\.extraheader$' | head -n 1 || true)
if [ -n "$header" ]; then
    git -C "$work" config "${header%% *}" "${header#* }"
fi
git -C "$work" config user.name "github-actions[bot]"
git -C "$work" config user.email "41898282+github-actions[bot]@users.noreply.github.com"

for attempt in 1 2 3 4 5; do
    if git -C "$work" fetch --quiet --depth 1 origin "refs/heads/$branch" 2>/dev/null; then
        git -C "$work" checkout --quiet --force -B pictures FETCH_HEAD
    else
        git -C "$work" checkout --quiet --orphan "pictures$attempt"
        git -C "$work" rm -rf --quiet --ignore-unmatch .
    fi
    (cd "$report" && find . -name '*.png' -print0 | while IFS= read -r -d '' file; do
        mkdir -p "$work/$folder/$(dirname "$file")" && cp "$file" "$work/$folder/$file"
    done)
    # Runs are numbered in their order.
    (cd "$work" && find . -mindepth 1 -maxdepth 1 -type d -not -name .git -printf '%f\n' \
        | sort -t- -k1,1n -k2,2n | head -n "-$most" | xargs -r rm -rf --)
    git -C "$work" add --all
    git -C "$work" diff --cached --quiet && exit 0
    git -C "$work" commit --quiet -m "Pictures of run $folder"
    git -C "$work" push --quiet origin "HEAD:refs/heads/$branch" && exit 0
    sleep "$attempt"
done
echo "the pictures could not be pushed to $branch; has the job \"permissions: contents: write\"?" >&2
exit 1
