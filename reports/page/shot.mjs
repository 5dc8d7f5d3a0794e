import { chromium } from "playwright-core";
const [file, out, width = "1200", scheme = "light", sel] = process.argv.slice(2);
const b = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox","--disable-gpu","--no-first-run","--disable-background-networking","--disable-component-update","--disable-sync","--allow-file-access-from-files"] });
const p = await b.newPage({ viewport: { width: +width, height: 900 }, colorScheme: scheme });
p.on("console", m => console.log("console", m.type(), m.text())); p.on("pageerror", e => console.log("ERR", e.stack)); p.on("request", r => r.url().startsWith("file:")||console.log("REQ", r.url().slice(0,100)));
const t=Date.now(); await p.goto("file://"+file); console.log("load ms", Date.now()-t, await p.evaluate(()=>document.documentElement.dataset.ready), "scrollW", await p.evaluate(()=>document.documentElement.scrollWidth));
const H = await p.evaluate(()=>document.documentElement.scrollHeight);
for (let y=0;y<H+3000;y+=700){ await p.evaluate(y=>window.scrollTo(0,y),y); await p.waitForTimeout(60);} 
await p.waitForTimeout(500); await p.evaluate(()=>window.scrollTo(0,0));
console.log("missing:", await p.$$eval(".missing", e=>e.map(x=>x.textContent)));
console.log("scrollW", await p.evaluate(()=>document.documentElement.scrollWidth));
if (sel) { for (const [i,s] of sel.split(";").entries()) await p.locator(s).first().screenshot({path: out.replace(".png",`-${i}.png`)}); }
else { const h = await p.evaluate(()=>document.documentElement.scrollHeight); console.log("height",h); for (let i=0;i*2400<h && i<8;i++) await p.screenshot({path: out.replace(".png",`-${i}.png`), fullPage:true, clip:{x:0,y:i*2400,width:+width,height:Math.min(2400,h-i*2400)}}); }
await b.close();
