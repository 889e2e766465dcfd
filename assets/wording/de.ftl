# Was Recto Besuchern sagt, auf Deutsch.

language-name = Deutsch

## Bedienung

flip = Wenden
lamp = Lampe
scenes = Ansichten
compare = Vergleichen
overlays = Ebenen
light-table = Leuchttisch
measure = Messen
home = Anfang
language = Sprache
text-size = Schriftgröße
contrast = Kontrast
motion = Bewegung
help = Hilfe
close = Schließen
next = Weiter
previous = Vorige
back = Zurück
done = Fertig
take-back = Rückgängig
more = Mehr
enlarge = Große Schrift
normal-size = Normalschrift
high-contrast = Hoher Kontrast
reduced-motion = Ruhiger
zoom-in = Näher
zoom-out = Weiter weg
true-size = Originalgröße
hotspots = Details
caption = Bildtext
legend = Legende

## Das Blatt

recto = Recto
verso = Verso
before = Vorher
after = Nachher

## Lampe

zenithal = Von oben
oblique = Unter 45°
raking-left = Von links
raking-right = Von rechts
raking-top = Vom Oberrand
raking-bottom = Vom Unterrand
intensity = Helligkeit
brighter = Heller
dimmer = Dunkler
warmer = Wärmer
cooler = Kühler
lamp-elevation = { $elevation }° hoch
lamp-azimuth = aus { $azimuth }°
intensity-times = Helligkeit × { $times }
light-table-share = Leuchttisch { $share } %
colour-temperature = { $kelvin } K
lamp-overhead = Lampe senkrecht darüber
lamp-place = Lampe { $elevation }° hoch, { $from ->
        [right] von rechts
        [upper-right] von rechts oben
        [top] vom oberen Rand
        [upper-left] von links oben
        [left] von links
        [lower-left] von links unten
        [bottom] vom unteren Rand
       *[lower-right] von rechts unten
    } ({ $azimuth }°)

## Vergleiche und Ebenen

curtain = Vorhang
side-by-side = Nebeneinander
blend = Überblenden
loupe = Lupe
difference = Unterschied
flicker = Im Wechsel
glass = Durchsicht
opacity = Stärke
opacity-share = Stärke { $share } %
no-overlay = Keine Ebene
no-state = das Blatt selbst
comparing-curtain = Vorhang
comparing-side-by-side = nebeneinander
comparing-blend = überblendet, { $share } % vom zweiten
comparing-loupe = Lupe, { $times }fach
comparing-difference = Unterschied
comparing-flicker = im Wechsel, Nummer { $number }
comparing-glass = Durchsicht, { $share } % der anderen Seite
light-through = { $share } % des Lichts durch das Blatt

## Messen

ruler = Lineal
line = Weg
area = Fläche
angle = Winkel
profile = Relief
laid-lines = Siebstruktur
stroke = Strich
probe = Farbe
reading-out = Was hier ist
ruler-hint = Zwei Stellen berühren
line-hint = Stelle um Stelle berühren, die letzte zweimal
area-hint = Die Ecken berühren, die letzte zweimal
angle-hint = Drei Stellen berühren; die zweite ist der Scheitel
profile-hint = Beide Enden einer Linie berühren
laid-lines-hint = Zwei Ecken eines Bereichs ohne Löcher berühren
stroke-hint = Das Papier zu beiden Seiten des Strichs berühren
probe-hint = Eine Stelle berühren
difference-hint = Zwei Stellen eines Blattes berühren
reading-hint = Das Blatt berühren, um zu lesen, was dort ist

## Bildtext

at-true-size = Originalgröße
at-true-size-perhaps = Originalgröße, falls der Bildschirm 96 Pixel pro Zoll hat
tier-draft = Entwurf
tier-study = Studie
no-hotspots = keine Details auf dieser Seite
hotspot-leads = Noch einmal berühren: { $title }

## Legende

legend-layer = { $title } · { $share } %
legend-luminance = { $value } der Leuchtdichte von Weiß
legend-band = Reflexionsgrad bei { $band }
legend-difference = Reflexionsgrad bei { $first } − { $second }
legend-bands = Rot { $red }, Grün { $green }, Blau { $blue }
enhanced-relief = nur Relief, ohne Farbe
enhanced-steepness = Relief { $times }-mal so steil
enhanced-contrast = Kontrast gedehnt: { $low } bis { $high } % von Weiß
enhanced-sharpness = geschärft: { $share } %

## Hinweise

touch-to-turn = Ein Finger dreht das Blatt
touch-to-move = Ein Finger verschiebt das Blatt
pinch-to-zoom = Zwei Finger holen es näher
drag-lamp = Die Lampe halten und bewegen
two-visitors = Eine Person hält das Blatt, eine andere die Lampe
attract-invitation = Berühren Sie das Blatt
countdown = { $seconds ->
        [one] Zurück zum Anfang in { $seconds } Sekunde
       *[other] Zurück zum Anfang in { $seconds } Sekunden
    }
stay = Ich bin noch da
closed = Geschlossen

## Personal

staff-pin = PIN des Personals
staff-wrong = Falsche PIN
staff-wait = { $seconds ->
        [one] { $seconds } Sekunde warten
       *[other] { $seconds } Sekunden warten
    }
staff-quit = Recto beenden
staff-restart = Neu starten
staff-next-exhibit = Nächste Ausstellung
staff-chart = Testbild
staff-hours-off = Jetzt geöffnet lassen
staff-panel = Personal

## Messwerte

reading = { $quantity }: { $value }
reading-none = { $quantity }: keine Angabe
reading-waiting = wird gemessen …
reading-nothing = hier ist nichts zu messen
reading-none-why = { $quantity }: keine Angabe, { $why }
reading-failed = nicht gemessen: { $why }
why-off-sheet = eine Stelle liegt neben dem Blatt
why-too-wide = es ist breiter als das Blatt
why-no-picture = diese Seite hat kein Bild
why-no-height = das Relief dieser Seite wurde nicht erfasst
why-unreadable = eine Datei ist nicht lesbar
why-gone = die Zeichnung oder ihr Zustand ist nicht mehr da
why-one-place = zwei Stellen liegen zu nah beieinander
why-crosses-itself = der Umriss kreuzt sich
why-no-area = die Ecken liegen auf einer Linie
why-no-stroke = hier ist kein Strich
why-several-strokes = hier ist mehr als ein Strich
why-no-paper = an beiden Enden fehlt leeres Papier
why-oblique = der Strich läuft { $degrees }° schräg; die Linie drehen
why-too-little = zu wenig davon liegt auf dem Blatt
why-coarse = das Bild ist zu grob
why-small = der Bereich ist zu klein
why-covered = dort ist zu viel gezeichnet
why-faint = keine Linien heben sich ab
note-unregistered = wie genau { $file } auf dem Blatt liegt, ist nicht bekannt und nicht eingerechnet
note-fitted = { $file } ist angepasst, nicht gemessen: die Unsicherheit ist die des Ablesens
note-assumed = { $file } ist angenommen, nicht gemessen: die Unsicherheit ist die des Ablesens
note-no-picture = diese Seite hat kein Bild: die Unsicherheit ist allein die des Zeigens
note-stroke = aus { $file } in halber Tiefe abgelesen, über { $length } des Strichs
note-lines = aus { $file } abgelesen; Richtungen im Uhrzeigersinn von der Waagerechten
note-colours = Farben von { $file } bei Tageslicht (D65), gleich welche Lampe brennt
under-place = { $across } mm von links, { $down } mm von oben
under-nothing = nichts
under-false-colour = Falschfarbe, Rot { $red }, Grün { $green }, Blau { $blue }
under-reflectance = { $value } Reflexionsgrad
quantity-length = Länge
quantity-area = Fläche
quantity-perimeter = Umfang
quantity-angle = Winkel
quantity-width = Breite
quantity-height = Höhe
quantity-roughness = Rauheit
quantity-trend = Neigung
quantity-laid-spacing = Abstand der Ripplinien
quantity-laid-direction = Richtung der Ripplinien
quantity-chain-spacing = Abstand der Kettlinien
quantity-chain-direction = Richtung der Kettlinien
quantity-difference = Unterschied ΔE00

## Meldungen

saved = als Ansicht { $name } gespeichert
not-saved = nicht gespeichert: das Terminal sagt, warum
not-saved-changed = nicht gespeichert: das Manifest hat sich inzwischen geändert
not-saved-read-only = nicht gespeichert: das Manifest ist schreibgeschützt
not-saved-unwritable = nicht gespeichert: das Manifest lässt sich nicht schreiben
not-saved-at-fault = nicht gespeichert: das Manifest ist fehlerhaft
link-printed = ein Verweis steht im Terminal
exporting = wird nach { $file } ausgegeben …
exported = ausgegeben: { $file }
not-exported = nicht ausgegeben: das Terminal sagt, warum

## Tastatur und Maus

keys-drag = ziehen
keys-wheel = Mausrad, + −
keys-double-click = Doppelklick
keys-arrows = Pfeiltasten
keys-lamp = rechts ziehen, L + ziehen, Umschalt + Pfeile
keyboard-shift = Umschalt
keyboard-control = Strg
keyboard-enter = Eingabe
keyboard-backspace = Rücktaste
keyboard-space = Leertaste
key-turn = das Blatt drehen, von nahem verschieben
key-zoom = näher, weiter weg
key-true-size = Originalgröße und zurück
key-move = von nahem verschieben
key-flip = das Blatt wenden
key-lamp = die Lampe bewegen
key-presets = Lampe senkrecht, unter 45°, streifend
key-state = nächster Zustand, zurück
key-overlays = Ebenen: keine, jede, alle
key-opacity = Ebenen schwächer, stärker
key-category = nächste Kategorie allein, zurück
key-compare = nächster Vergleich, zurück
key-share = den Vorhang bewegen, mehr oder weniger überblenden
key-angle = den Vorhang drehen, größere Lupe, ΔE00 oder Licht
key-through = weniger, mehr Licht durch das Blatt
key-enhance = nur Relief, steiler, Kontrast, schärfer
key-scene = nächste Ansicht, zurück
key-home = die Ansicht, wie sie war
key-hotspots = Details: ein Klick öffnet, zwei führen hin
key-next-hotspot = nächstes Detail, zurück, zu seiner Ansicht
key-next-control = nächstes Bedienelement, zurück, betätigen
key-controls = Bedienung
key-measure = nächstes Messwerkzeug, zurück: ein Klick legt es an
key-end-path = einen Weg beenden, Stelle oder Messung zurücknehmen
key-under = was unter dem Zeiger liegt
key-save = die Ansicht speichern
key-link = einen Verweis auf die Ansicht ausgeben
key-export = eine Abbildung ausgeben, oder ihr Licht als EXR
key-tier = nächste Genauigkeitsstufe, zurück
key-caption = Bildtext
key-escape = Vollbild, weglegen, schließen oder beenden
