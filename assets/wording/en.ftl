# What Recto says to visitors, in English. A museum changes it without touching this file: a folder
# of its own with files named LANGUAGE.ftl, each with the messages that are to read otherwise.
# Names in { $… } are filled in by the program. Labels of buttons have at most 14 letters.

# The name of this language in itself.
language-name = English

## Controls

flip = Turn over
lamp = Lamp
scenes = Views
compare = Compare
overlays = Layers
light-table = Light table
measure = Measure
home = Start
language = Language
text-size = Text size
contrast = Contrast
motion = Motion
help = Help
close = Close
next = Next
previous = Previous
back = Back
done = Done
take-back = Undo
more = More
enlarge = Larger text
normal-size = Normal text
high-contrast = High contrast
reduced-motion = Less motion
zoom-in = Closer
zoom-out = Further
true-size = True size
hotspots = Details
caption = Caption
legend = Legend

## The sheet

recto = Recto
verso = Verso
before = Before
after = After

## Lamp

zenithal = Overhead
oblique = At 45°
raking-left = From left
raking-right = From right
raking-top = From top
raking-bottom = From bottom
intensity = Brightness
brighter = Brighter
dimmer = Dimmer
warmer = Warmer
cooler = Cooler
# How high the lamp stands above the sheet, in degrees.
lamp-elevation = { $elevation }° high
# The direction from which it shines, in degrees anticlockwise from the right.
lamp-azimuth = from { $azimuth }°
intensity-times = Brightness × { $times }
light-table-share = Light table { $share }%
colour-temperature = { $kelvin } K
lamp-overhead = lamp overhead
# $from is one of right, upper-right, top, upper-left, left, lower-left, bottom, lower-right.
lamp-place = lamp { $elevation }° high, from { $from ->
        [right] the right
        [upper-right] the upper right
        [top] the top
        [upper-left] the upper left
        [left] the left
        [lower-left] the lower left
        [bottom] the bottom
       *[lower-right] the lower right
    } ({ $azimuth }°)

## Comparisons and layers

curtain = Curtain
side-by-side = Side by side
blend = Blend
loupe = Loupe
difference = Difference
flicker = In turns
glass = Through sheet
opacity = Strength
opacity-share = Strength { $share }%
no-overlay = No layer
no-state = the sheet itself
comparing-curtain = curtain
comparing-side-by-side = side by side
comparing-blend = blend, { $share }% of the second
comparing-loupe = loupe, { $times } times
comparing-difference = difference
comparing-flicker = in turns, number { $number }
comparing-glass = through the sheet, { $share }% of the other side
light-through = { $share }% of the light through the sheet

## Measuring

ruler = Ruler
line = Path
area = Area
angle = Angle
profile = Relief
laid-lines = Laid lines
stroke = Stroke
probe = Colour
reading-out = What lies here
ruler-hint = Touch two places
line-hint = Touch place after place, the last one twice
area-hint = Touch its corners, the last one twice
angle-hint = Touch three places; the second is the corner
profile-hint = Touch both ends of a line
laid-lines-hint = Touch two corners of a region without holes
stroke-hint = Touch the paper on both sides of the stroke
probe-hint = Touch one place
difference-hint = Touch two places on one sheet
reading-hint = Touch the sheet to read what lies there

## Caption

at-true-size = true size
at-true-size-perhaps = true size, if the display has 96 pixels an inch
# How exactly light is computed, where it is not as usual.
tier-draft = draft
tier-study = study
no-hotspots = no details on this side
# Where a detail leads.
hotspot-leads = Touch again: { $title }

## Legend

# A layer and how strong it is.
legend-layer = { $title } · { $share } %
legend-luminance = { $value } of white's luminance
legend-band = reflectance at { $band }
legend-difference = reflectance at { $first } − { $second }
legend-bands = red { $red }, green { $green }, blue { $blue }
enhanced-relief = relief only, without colour
enhanced-steepness = relief { $times } times as steep
enhanced-contrast = contrast stretched: { $low } to { $high } % of white
enhanced-sharpness = sharpened: { $share } %

## Hints

touch-to-turn = One finger turns the sheet
touch-to-move = One finger moves the sheet
pinch-to-zoom = Two fingers bring it closer
drag-lamp = Hold the lamp and move it
two-visitors = One of you may hold the sheet, another the lamp
attract-invitation = Touch the sheet
countdown = { $seconds ->
        [one] Back to the start in { $seconds } second
       *[other] Back to the start in { $seconds } seconds
    }
stay = I am still here
closed = Closed

## Staff

staff-pin = Staff PIN
staff-wrong = Wrong PIN
staff-wait = { $seconds ->
        [one] Wait { $seconds } second
       *[other] Wait { $seconds } seconds
    }
staff-quit = Quit Recto
staff-restart = Restart
staff-next-exhibit = Next exhibit
staff-chart = Test chart
staff-hours-off = Stay open now
staff-panel = Staff

## Readings

reading = { $quantity }: { $value }
reading-none = { $quantity }: none
reading-waiting = measuring …
reading-nothing = nothing to measure here
reading-none-why = { $quantity }: none, { $why }
reading-failed = not measured: { $why }
# Why nothing was measured; each stands behind "not measured:".
why-off-sheet = a place lies beside the sheet
why-too-wide = it is wider than the sheet
why-no-picture = this side has no picture
why-no-height = the relief of this side was not recorded
why-unreadable = a file cannot be read
why-gone = its drawing or its state is gone
why-one-place = two places lie too close together
why-crosses-itself = the outline crosses itself
why-no-area = its corners lie on one line
why-no-stroke = there is no stroke here
why-several-strokes = there is more than one stroke here
why-no-paper = there is no bare paper at both ends
why-oblique = the stroke runs { $degrees }° off square; turn the line
why-too-little = too little of it lies on the sheet
why-coarse = the picture is too coarse
why-small = the region is too small
why-covered = too much is drawn there
why-faint = no lines stand out
# What else is to be known of what was measured; $file is a picture.
note-unregistered = how exactly { $file } lies on the sheet is not known, and not counted in
note-fitted = { $file } is fitted, not measured: the uncertainty is that of reading it
note-assumed = { $file } is assumed, not measured: the uncertainty is that of reading it
note-no-picture = this side has no picture: the uncertainty is that of pointing alone
note-stroke = read from { $file } at half depth, over { $length } of the stroke
note-lines = read from { $file }; directions are clockwise from the horizontal
note-colours = colours are those of { $file } in daylight (D65), whatever lamp is lit
# What lies under the pointer: a place in mm from the left and the top edge, and what layers say there.
under-place = { $across } mm across, { $down } mm down
under-nothing = nothing
under-false-colour = false colour, red { $red }, green { $green }, blue { $blue }
under-reflectance = { $value } of reflectance
quantity-length = length
quantity-area = area
quantity-perimeter = perimeter
quantity-angle = angle
quantity-width = width
quantity-height = height
quantity-roughness = roughness
quantity-trend = slope
quantity-laid-spacing = spacing of laid lines
quantity-laid-direction = direction of laid lines
quantity-chain-spacing = spacing of chain lines
quantity-chain-direction = direction of chain lines
quantity-difference = difference ΔE00

## Notices

saved = saved as view { $name }
not-saved = not saved: the terminal says why
not-saved-changed = not saved: the manifest has changed meanwhile
not-saved-read-only = not saved: the manifest is read-only
not-saved-unwritable = not saved: the manifest cannot be written
not-saved-at-fault = not saved: the manifest is at fault
link-printed = a link is in the terminal
exporting = exporting to { $file } …
exported = exported: { $file }
not-exported = not exported: the terminal says why

## Keyboard and mouse

keys-drag = drag
keys-wheel = wheel, + −
keys-double-click = double click
keys-arrows = arrows
keys-lamp = right drag, L + drag, Shift + arrows
# Names on keys.
keyboard-shift = Shift
keyboard-control = Ctrl
keyboard-enter = Enter
keyboard-backspace = Backspace
keyboard-space = Space
key-turn = turn the sheet; move it when zoomed in
key-zoom = closer, further
key-true-size = true size and back
key-move = move when zoomed in
key-flip = turn the sheet over
key-lamp = move the lamp
key-presets = lamp overhead, at 45°, raking
key-state = next state, back
key-overlays = layers: none, each, all
key-opacity = fainter, stronger layers
key-category = next category alone, back
key-compare = next comparison, back
key-share = move the curtain, more or less of a blend
key-angle = turn the curtain, larger loupe, ΔE00 or light
key-through = less, more light through the sheet
key-enhance = relief only, steeper, contrast, sharper
key-scene = next view, back
key-home = the view as it was
key-hotspots = details: click on one to open it, twice to go there
key-next-hotspot = next detail, back, to its view
key-next-control = next control, back, touch it
key-controls = controls
key-measure = next measuring tool, back: click to lay it
key-end-path = end a path, take back a place or a measurement
key-under = what lies under the pointer
key-save = save the view
key-link = print a link to the view
key-export = export a figure, or its light as EXR
key-tier = next tier of accuracy, back
key-caption = caption
key-escape = full screen, put away, close or quit
