#!/usr/bin/env bash
# Make lcmtools/gui/static/vendor/three from npm, in the versions of package.json: web/vendor.sh
# esbuild joins what three.js names here into one module and leaves out the rest.
set -e
cd "$(dirname "${BASH_SOURCE[0]}")"
npm install --no-audit --no-fund --ignore-scripts
folder=../lcmtools/gui/static/vendor/three
version=$(sed -n 's/.*"version": "\(.*\)".*/\1/p' node_modules/three/package.json | head -1)
mkdir -p "$folder"
npx esbuild three.js --bundle --minify --format=esm --legal-comments=none --target=es2022 \
  --banner:js="// three.js $version, see LICENSE; made by web/vendor.sh" --outfile="$folder/three.js"
cp node_modules/three/LICENSE "$folder/LICENSE"
# For the type checker these are classes of anything: its own types are not vendored.
sed -n 's/^  \([A-Za-z0-9]*\),$/\1/p; s/^export { \([A-Za-z0-9]*\) } .*/\1/p' three.js |
  sed -E 's/^.*(ToneMapping|Map|Side|Filter|Format|ColorSpace)$/export const &: any;/; t
          s/.*/export class & { constructor(...values: any[]); [name: string]: any }/' > "$folder/three.d.ts"
