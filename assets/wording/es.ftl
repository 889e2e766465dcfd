# Lo que Recto dice a los visitantes, en español.

language-name = Español

## Mandos

flip = Dar la vuelta
lamp = Lámpara
scenes = Vistas
compare = Comparar
overlays = Capas
light-table = Mesa de luz
measure = Medir
home = Inicio
language = Idioma
text-size = Texto
contrast = Contraste
motion = Movimiento
help = Ayuda
close = Cerrar
next = Siguiente
previous = Anterior
back = Volver
done = Hecho
take-back = Deshacer
more = Más
enlarge = Texto grande
normal-size = Texto normal
high-contrast = Alto contraste
reduced-motion = Menos animado
zoom-in = Más cerca
zoom-out = Más lejos
true-size = Tamaño real
hotspots = Detalles
caption = Cartela
legend = Leyenda

## La hoja

recto = Recto
verso = Verso
before = Antes
after = Después

## Lámpara

zenithal = Cenital
oblique = A 45°
raking-left = Izquierda
raking-right = Derecha
raking-top = Arriba
raking-bottom = Abajo
intensity = Brillo
brighter = Más clara
dimmer = Más oscura
warmer = Más cálida
cooler = Más fría
lamp-elevation = altura { $elevation }°
lamp-azimuth = dirección { $azimuth }°
intensity-times = Brillo × { $times }
light-table-share = Mesa de luz { $share } %
colour-temperature = { $kelvin } K
lamp-overhead = lámpara cenital
lamp-place = lámpara a { $elevation }° de altura, { $from ->
        [right] desde la derecha
        [upper-right] desde arriba a la derecha
        [top] desde arriba
        [upper-left] desde arriba a la izquierda
        [left] desde la izquierda
        [lower-left] desde abajo a la izquierda
        [bottom] desde abajo
       *[lower-right] desde abajo a la derecha
    } ({ $azimuth }°)

## Comparaciones y capas

curtain = Cortina
side-by-side = Lado a lado
blend = Fundido
loupe = Lupa
difference = Diferencia
flicker = Por turnos
glass = Transparencia
opacity = Intensidad
opacity-share = Intensidad { $share } %
no-overlay = Ninguna capa
no-state = la hoja misma
comparing-curtain = cortina
comparing-side-by-side = lado a lado
comparing-blend = fundido, { $share } % del segundo
comparing-loupe = lupa, { $times } aumentos
comparing-difference = diferencia
comparing-flicker = por turnos, número { $number }
comparing-glass = por transparencia, { $share } % del otro lado
light-through = { $share } % de la luz a través de la hoja

## Medir

ruler = Regla
line = Recorrido
area = Superficie
angle = Ángulo
profile = Relieve
laid-lines = Puntizones
stroke = Trazo
probe = Color
reading-out = Qué hay aquí
ruler-hint = Toque dos puntos
line-hint = Toque un punto tras otro, el último dos veces
area-hint = Toque las esquinas, la última dos veces
angle-hint = Toque tres puntos; el segundo es el vértice
profile-hint = Toque los dos extremos de una línea
laid-lines-hint = Toque dos esquinas de una zona sin agujeros
stroke-hint = Toque el papel a ambos lados del trazo
probe-hint = Toque un punto
difference-hint = Toque dos puntos de una misma hoja
reading-hint = Toque la hoja para leer qué hay en ella

## Cartela

at-true-size = tamaño real
at-true-size-perhaps = tamaño real, si la pantalla tiene 96 píxeles por pulgada
tier-draft = borrador
tier-study = estudio
no-hotspots = ningún detalle en este lado
hotspot-leads = Toque otra vez: { $title }

## Leyenda

legend-layer = { $title } · { $share } %
legend-luminance = { $value } de la luminancia del blanco
legend-band = reflectancia a { $band }
legend-difference = reflectancia a { $first } − { $second }
legend-bands = rojo { $red }, verde { $green }, azul { $blue }
enhanced-relief = solo relieve, sin color
enhanced-steepness = relieve { $times } veces más marcado
enhanced-contrast = contraste ampliado: del { $low } al { $high } % del blanco
enhanced-sharpness = nitidez: { $share } %

## Consejos

touch-to-turn = Un dedo gira la hoja
touch-to-move = Un dedo mueve la hoja
pinch-to-zoom = Dos dedos la acercan
drag-lamp = Sujete la lámpara y muévala
two-visitors = Una persona puede sujetar la hoja y otra la lámpara
attract-invitation = Toque la hoja
countdown = { $seconds ->
        [one] Vuelta al inicio en { $seconds } segundo
        [many] Vuelta al inicio en { $seconds } segundos
       *[other] Vuelta al inicio en { $seconds } segundos
    }
stay = Sigo aquí
closed = Cerrado

## Personal

staff-pin = PIN del personal
staff-wrong = PIN incorrecto
staff-wait = { $seconds ->
        [one] Espere { $seconds } segundo
        [many] Espere { $seconds } segundos
       *[other] Espere { $seconds } segundos
    }
staff-quit = Salir de Recto
staff-restart = Reiniciar
staff-next-exhibit = Exposición siguiente
staff-chart = Carta de prueba
staff-hours-off = Seguir abierto
staff-panel = Personal

## Medidas

reading = { $quantity }: { $value }
reading-none = { $quantity }: ninguno
reading-waiting = midiendo…
reading-nothing = aquí no hay nada que medir
reading-none-why = { $quantity }: ninguno, { $why }
reading-failed = no medido: { $why }
why-off-sheet = un punto está fuera de la hoja
why-too-wide = es más ancho que la hoja
why-no-picture = este lado no tiene imagen
why-no-height = el relieve de este lado no se registró
why-unreadable = un archivo no se puede leer
why-gone = el dibujo o su estado ya no está
why-one-place = dos puntos están demasiado cerca
why-crosses-itself = el contorno se cruza
why-no-area = las esquinas están en una sola línea
why-no-stroke = aquí no hay ningún trazo
why-several-strokes = aquí hay más de un trazo
why-no-paper = no hay papel desnudo en ambos extremos
why-oblique = el trazo está { $degrees }° inclinado; gire la línea
why-too-little = hay demasiado poco sobre la hoja
why-coarse = la imagen es demasiado tosca
why-small = la zona es demasiado pequeña
why-covered = hay demasiado dibujo
why-faint = no destaca ninguna línea
note-unregistered = no se sabe con qué exactitud { $file } está sobre la hoja; no se ha contado
note-fitted = { $file } está ajustado, no medido: la incertidumbre es la de la lectura
note-assumed = { $file } está supuesto, no medido: la incertidumbre es la de la lectura
note-no-picture = este lado no tiene imagen: la incertidumbre es solo la de señalar
note-stroke = leído en { $file } a media profundidad, a lo largo de { $length } del trazo
note-lines = leído en { $file }; direcciones en sentido horario desde la horizontal
note-colours = colores de { $file } a la luz del día (D65), sea cual sea la lámpara
under-place = { $across } mm desde la izquierda, { $down } mm desde arriba
under-nothing = nada
under-false-colour = falso color, rojo { $red }, verde { $green }, azul { $blue }
under-reflectance = { $value } de reflectancia
quantity-length = longitud
quantity-area = superficie
quantity-perimeter = perímetro
quantity-angle = ángulo
quantity-width = anchura
quantity-height = altura
quantity-roughness = rugosidad
quantity-trend = pendiente
quantity-laid-spacing = distancia entre puntizones
quantity-laid-direction = dirección de los puntizones
quantity-chain-spacing = distancia entre corondeles
quantity-chain-direction = dirección de los corondeles
quantity-difference = diferencia ΔE00

## Avisos

saved = guardada como vista { $name }
not-saved = no guardada: el terminal dice por qué
not-saved-changed = no guardada: el manifiesto ha cambiado entretanto
not-saved-read-only = no guardada: el manifiesto es de solo lectura
not-saved-unwritable = no guardada: el manifiesto no se puede escribir
not-saved-at-fault = no guardada: el manifiesto tiene errores
link-printed = hay un enlace en el terminal
exporting = exportando a { $file }…
exported = exportado: { $file }
not-exported = no exportado: el terminal dice por qué

## Teclado y ratón

keys-drag = arrastrar
keys-wheel = rueda, + −
keys-double-click = doble clic
keys-arrows = flechas
keys-lamp = arrastrar con el derecho, L + arrastrar, Mayús + flechas
keyboard-shift = Mayús
keyboard-control = Ctrl
keyboard-enter = Intro
keyboard-backspace = Retroceso
keyboard-space = Espacio
key-turn = girar la hoja; moverla de cerca
key-zoom = más cerca, más lejos
key-true-size = tamaño real y vuelta
key-move = mover de cerca
key-flip = dar la vuelta a la hoja
key-lamp = mover la lámpara
key-presets = lámpara cenital, a 45°, rasante
key-state = estado siguiente, anterior
key-overlays = capas: ninguna, cada una, todas
key-opacity = capas más tenues, más fuertes
key-category = categoría siguiente sola, anterior
key-compare = comparación siguiente, anterior
key-share = mover la cortina, más o menos fundido
key-angle = girar la cortina, lupa más grande, ΔE00 o luz
key-through = menos, más luz a través de la hoja
key-enhance = solo relieve, más marcado, contraste, más nítido
key-scene = vista siguiente, anterior
key-home = la vista como estaba
key-hotspots = detalles: un clic lo abre, dos llevan allí
key-next-hotspot = detalle siguiente, anterior, a su vista
key-next-control = mando siguiente, anterior, pulsarlo
key-controls = mandos
key-measure = herramienta de medida siguiente, anterior: un clic la coloca
key-end-path = terminar un recorrido, deshacer un punto o una medida
key-under = qué hay bajo el puntero
key-save = guardar la vista
key-link = mostrar un enlace a la vista
key-export = exportar una figura, o su luz en EXR
key-tier = nivel de exactitud siguiente, anterior
key-caption = cartela
key-escape = pantalla completa, guardar, cerrar o salir
