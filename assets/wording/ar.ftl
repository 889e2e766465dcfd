# ما يقوله Recto للزوّار بالعربية.

language-name = العربية

## أدوات التحكم

flip = اقلب
lamp = المصباح
scenes = مشاهد
compare = مقارنة
overlays = طبقات
light-table = طاولة ضوئية
measure = قياس
home = البداية
language = اللغة
text-size = حجم النص
contrast = التباين
motion = الحركة
help = مساعدة
close = إغلاق
next = التالي
previous = السابق
back = رجوع
done = تم
take-back = تراجع
more = المزيد
enlarge = نص أكبر
normal-size = نص عادي
high-contrast = تباين عالٍ
reduced-motion = حركة أقل
zoom-in = أقرب
zoom-out = أبعد
true-size = الحجم الحقيقي
hotspots = تفاصيل
caption = الشرح
legend = مفتاح الألوان

## الورقة

recto = الوجه
verso = الظهر
before = قبل
after = بعد

## المصباح

zenithal = من فوق
oblique = بزاوية 45°
raking-left = من اليسار
raking-right = من اليمين
raking-top = من الأعلى
raking-bottom = من الأسفل
intensity = السطوع
brighter = أسطع
dimmer = أخفت
warmer = أدفأ
cooler = أبرد
lamp-elevation = الارتفاع { $elevation }°
lamp-azimuth = الاتجاه { $azimuth }°
intensity-times = السطوع × { $times }
light-table-share = طاولة ضوئية { $share }٪
colour-temperature = { $kelvin } كلفن
lamp-overhead = المصباح فوق الورقة مباشرة
lamp-place = المصباح على ارتفاع { $elevation }°، { $from ->
        [right] من اليمين
        [upper-right] من أعلى اليمين
        [top] من الأعلى
        [upper-left] من أعلى اليسار
        [left] من اليسار
        [lower-left] من أسفل اليسار
        [bottom] من الأسفل
       *[lower-right] من أسفل اليمين
    } ({ $azimuth }°)

## المقارنات والطبقات

curtain = ستارة
side-by-side = جنبًا إلى جنب
blend = مزج
loupe = عدسة
difference = الفرق
flicker = بالتناوب
glass = شفافية
opacity = الشدة
opacity-share = الشدة { $share }٪
no-overlay = بلا طبقة
no-state = الورقة نفسها
comparing-curtain = ستارة
comparing-side-by-side = جنبًا إلى جنب
comparing-blend = مزج، { $share }٪ من الثاني
comparing-loupe = عدسة، تكبير { $times }
comparing-difference = الفرق
comparing-flicker = بالتناوب، رقم { $number }
comparing-glass = من خلال الورقة، { $share }٪ من الوجه الآخر
light-through = { $share }٪ من الضوء عبر الورقة

## القياس

ruler = مسطرة
line = مسار
area = مساحة
angle = زاوية
profile = تضاريس
laid-lines = خطوط الورق
stroke = خط الرسم
probe = اللون
reading-out = ماذا يوجد هنا
ruler-hint = المس نقطتين
line-hint = المس نقطة بعد أخرى، والأخيرة مرتين
area-hint = المس الزوايا، والأخيرة مرتين
angle-hint = المس ثلاث نقاط؛ الثانية هي الرأس
profile-hint = المس طرفي خط
laid-lines-hint = المس ركنين من منطقة بلا ثقوب
stroke-hint = المس الورق على جانبي الخط
probe-hint = المس نقطة واحدة
difference-hint = المس نقطتين على ورقة واحدة
reading-hint = المس الورقة لتقرأ ما يوجد فيها

## الشرح

at-true-size = بالحجم الحقيقي
at-true-size-perhaps = بالحجم الحقيقي، إن كانت الشاشة بدقة 96 بكسل في البوصة
tier-draft = مسودة
tier-study = دراسة
no-hotspots = لا تفاصيل على هذا الجانب
hotspot-leads = المس مرة أخرى: { $title }

## مفتاح الألوان

legend-layer = { $title } · { $share }٪
legend-luminance = { $value } من سطوع الأبيض
legend-band = الانعكاسية عند { $band }
legend-difference = الانعكاسية عند { $first } − { $second }
legend-bands = أحمر { $red }، أخضر { $green }، أزرق { $blue }
enhanced-relief = التضاريس فقط، بلا لون
enhanced-steepness = تضاريس أشد { $times } مرة
enhanced-contrast = تباين موسّع: من { $low } إلى { $high }٪ من الأبيض
enhanced-sharpness = زيادة الوضوح: { $share }٪

## إرشادات

touch-to-turn = إصبع واحدة تدير الورقة
touch-to-move = إصبع واحدة تحرّك الورقة
pinch-to-zoom = إصبعان تقرّبانها
drag-lamp = أمسك المصباح وحرّكه
two-visitors = يمكن لأحدكم أن يمسك الورقة ولآخر أن يمسك المصباح
attract-invitation = المس الورقة
countdown = { $seconds ->
        [zero] العودة إلى البداية الآن
        [one] العودة إلى البداية بعد ثانية واحدة
        [two] العودة إلى البداية بعد ثانيتين
        [few] العودة إلى البداية بعد { $seconds } ثوانٍ
        [many] العودة إلى البداية بعد { $seconds } ثانية
       *[other] العودة إلى البداية بعد { $seconds } ثانية
    }
stay = ما زلت هنا
closed = مغلق

## الموظفون

staff-pin = رمز الموظفين
staff-wrong = رمز خاطئ
staff-wait = { $seconds ->
        [zero] انتظر قليلًا
        [one] انتظر ثانية واحدة
        [two] انتظر ثانيتين
        [few] انتظر { $seconds } ثوانٍ
        [many] انتظر { $seconds } ثانية
       *[other] انتظر { $seconds } ثانية
    }
staff-quit = إنهاء Recto
staff-restart = إعادة التشغيل
staff-next-exhibit = المعرض التالي
staff-chart = لوحة اختبار
staff-hours-off = إبقاء العرض مفتوحًا
staff-panel = الموظفون

## قراءات

reading = { $quantity }: { $value }
reading-none = { $quantity }: لا يوجد
reading-waiting = جارٍ القياس…
reading-nothing = لا شيء يُقاس هنا
reading-none-why = { $quantity }: لا يوجد، { $why }
reading-failed = لم يُقَس: { $why }
why-off-sheet = إحدى النقاط خارج الورقة
why-too-wide = هذا أعرض من الورقة
why-no-picture = لا صورة لهذا الجانب
why-no-height = لم تُسجَّل تضاريس هذا الجانب
why-unreadable = لا يمكن قراءة أحد الملفات
why-gone = لم يعد الرسم أو حالته موجودًا
why-one-place = نقطتان متقاربتان جدًا
why-crosses-itself = المحيط يقطع نفسه
why-no-area = الأركان على خط واحد
why-no-stroke = لا خط مرسوم هنا
why-several-strokes = هنا أكثر من خط مرسوم
why-no-paper = لا ورق خاليًا عند الطرفين
why-oblique = الخط مائل بمقدار { $degrees }°؛ أدر خط القياس
why-too-little = القليل جدًا منه على الورقة
why-coarse = الصورة خشنة جدًا
why-small = المنطقة صغيرة جدًا
why-covered = الرسم كثير هناك
why-faint = لا تبرز أي خطوط
note-unregistered = لا تُعرف دقة موضع { $file } على الورقة، وهي غير محسوبة
note-fitted = { $file } مُواءَم وليس مقيسًا: الارتياب هو ارتياب القراءة
note-assumed = { $file } مُفترَض وليس مقيسًا: الارتياب هو ارتياب القراءة
note-no-picture = لا صورة لهذا الجانب: الارتياب هو ارتياب التأشير وحده
note-stroke = قُرئ من { $file } عند نصف العمق، على طول { $length } من الخط
note-lines = قُرئ من { $file }؛ الاتجاهات مع عقارب الساعة من الأفق
note-colours = الألوان ألوان { $file } في ضوء النهار (D65)، أيًا كان المصباح
under-place = { $across } مم من اليسار، { $down } مم من الأعلى
under-nothing = لا شيء
under-false-colour = لون زائف، أحمر { $red }، أخضر { $green }، أزرق { $blue }
under-reflectance = { $value } من الانعكاسية
quantity-length = الطول
quantity-area = المساحة
quantity-perimeter = المحيط
quantity-angle = الزاوية
quantity-width = العرض
quantity-height = الارتفاع
quantity-roughness = الخشونة
quantity-trend = الميل
quantity-laid-spacing = المسافة بين الخطوط الرفيعة
quantity-laid-direction = اتجاه الخطوط الرفيعة
quantity-chain-spacing = المسافة بين خطوط السلسلة
quantity-chain-direction = اتجاه خطوط السلسلة
quantity-difference = الفرق ΔE00

## إشعارات

saved = حُفظ كمشهد { $name }
not-saved = لم يُحفظ: السبب في الطرفية
not-saved-changed = لم يُحفظ: تغيّر ملف المعرض في هذه الأثناء
not-saved-read-only = لم يُحفظ: ملف المعرض للقراءة فقط
not-saved-unwritable = لم يُحفظ: لا يمكن الكتابة في ملف المعرض
not-saved-at-fault = لم يُحفظ: في ملف المعرض أخطاء
link-printed = يوجد رابط في الطرفية
exporting = جارٍ التصدير إلى { $file }…
exported = صُدّر: { $file }
not-exported = لم يُصدّر: السبب في الطرفية

## لوحة المفاتيح والفأرة

keys-drag = السحب
keys-wheel = العجلة، + −
keys-double-click = نقرة مزدوجة
keys-arrows = الأسهم
keys-lamp = السحب بالزر الأيمن، L + السحب، Shift + الأسهم
keyboard-shift = Shift
keyboard-control = Ctrl
keyboard-enter = Enter
keyboard-backspace = Backspace
keyboard-space = مسطرة المسافة
key-turn = تدوير الورقة، وتحريكها عند التكبير
key-zoom = أقرب، أبعد
key-true-size = الحجم الحقيقي والعودة
key-move = التحريك عند التكبير
key-flip = قلب الورقة
key-lamp = تحريك المصباح
key-presets = المصباح من فوق، بزاوية 45°، مائلًا
key-state = الحالة التالية، السابقة
key-overlays = الطبقات: لا شيء، واحدة واحدة، الكل
key-opacity = طبقات أخفت، أقوى
key-category = الفئة التالية وحدها، السابقة
key-compare = المقارنة التالية، السابقة
key-share = تحريك الستارة، مزج أكثر أو أقل
key-angle = تدوير الستارة، عدسة أكبر، ΔE00 أو الضوء
key-through = ضوء أقل، أكثر عبر الورقة
key-enhance = التضاريس فقط، أشد، التباين، أوضح
key-scene = المشهد التالي، السابق
key-home = المشهد كما كان
key-hotspots = التفاصيل: نقرة للفتح، نقرتان للذهاب إليها
key-next-hotspot = التفصيل التالي، السابق، إلى مشهده
key-next-control = الأداة التالية، السابقة، استعمالها
key-controls = أدوات التحكم
key-measure = أداة القياس التالية، السابقة: نقرة لوضعها
key-end-path = إنهاء المسار، التراجع عن نقطة أو قياس
key-under = ما تحت المؤشر
key-save = حفظ المشهد
key-link = إظهار رابط إلى المشهد
key-export = تصدير شكل، أو ضوئه بصيغة EXR
key-tier = درجة الدقة التالية، السابقة
key-caption = الشرح
key-escape = ملء الشاشة، إبعاد، إغلاق أو خروج
