#!/usr/bin/env bash
# Makes niivue.umd.js.gz anew from the npm registry. For another version change the three lines below.
set -euo pipefail
cd "$(dirname "$0")"
version=0.69.0
integrity=sha512-YMjQvJgD1W2b7DuoxkwlC4VxbrgIePRJ5qyQzXKxi2v2MBVg285P/CIQyg46oDDGDIcaNlbd+MhtO/edMbXJkA==
script_sha256=47b896b77ec4a5be3ef1949c33ad393b6f45629921f326c279000bcf51bdb4af

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
npm pack --silent --pack-destination "$folder" "@niivue/niivue@$version" >/dev/null
package=$folder/niivue-niivue-$version.tgz
[ "sha512-$(openssl dgst -sha512 -binary "$package" | base64 -w0)" = "$integrity" ]
tar -xzf "$package" -C "$folder" package/dist/niivue.umd.js
echo "$script_sha256  $folder/package/dist/niivue.umd.js" | sha256sum --check --quiet
gzip -9nc "$folder/package/dist/niivue.umd.js" >niivue.umd.js.gz
